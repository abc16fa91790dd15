#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>

#include "apps/process/descriptors.hpp"
#include "apps/process/signals.hpp"
#include "apps/soak/roles.hpp"
#include "apps/streams/attach.hpp"
#include "apps/trials/curve_watch.hpp"
#include "apps/trials/joint_motion.hpp"
#include "ipc/roles/internals.hpp"
#include "splinecast/producer.hpp"
#include "splinecast/reader.hpp"

namespace splinecast::apps {
namespace {

using std::chrono::milliseconds;

constexpr Time kProducerTick = milliseconds(2);
constexpr Time kReaderTick = milliseconds(20);
/// The lead of waypoints in motion, and the lead when the curve may have come to rest.
constexpr Time kLead = milliseconds(200);
constexpr Time kCatchUp = milliseconds(300);
constexpr Time kPatience = std::chrono::seconds(30);

/// One stream's producer.
class SoakProducer {
 public:
  SoakProducer(const std::string& stream, Time first, Time interval)
      : producer_(stream, {.dimensions = JointMotion::kJoints, .capacity = kRing}),
        next_(first),
        interval_(interval) {}

  void tick(Time now, const JointMotion& motion) {
    if (next_ - kLead > now) return;
    skip_past(now);
    while (next_ - kLead <= now) {
      const std::vector<double> x = motion.at(next_);
      const auto status = producer_.append({.time = next_, .position = x});
      ++(status == AppendStatus::accepted ? sent_ : refused_);
      next_ += interval_;
    }
  }

  /// Ends the stream. Returns false if the ring has no room for that until `end`.
  bool finish(const Clock& clock, Time end) {
    while (producer_.finish({.kind = ConditionKind::halt, .value = {}}) == AppendStatus::full) {
      if (!producer_.wait_for_room(end - clock.now())) return false;
    }
    return true;
  }
  bool wait_until_consumed(Time timeout) { return producer_.wait_until_consumed(timeout); }

  [[nodiscard]] std::size_t sent() const { return sent_; }
  [[nodiscard]] std::size_t refused() const { return refused_; }

 private:
  static constexpr std::size_t kRing = 256;

  /// Advances to the first waypoint that may follow the appended ones.
  void skip_past(Time now) {
    // A waypoint is late if less than half of its lead remains. A postponed waypoint has its whole
    // lead when it is due, so it is not postponed again.
    const bool is_late = producer_.earliest() > producer_.last_time() && next_ < now + kLead / 2;
    const Time earliest =
        producer_.continues() || sent_ > 0
            ? std::max(producer_.last_time() + interval_, is_late ? now + kCatchUp : Time::min())
            : now;
    if (next_ < earliest) next_ += interval_ * ((earliest - next_) / interval_ + 1);
  }

  Producer producer_;
  Time next_;
  Time interval_;
  std::size_t sent_ = 0;
  std::size_t refused_ = 0;
};

/// One stream as a reader process sees it.
struct WatchedStream {
  explicit WatchedStream(const std::string& stream)
      : reader(attach_reader(stream, kPatience)),
        watch(ipc::Internals::sampler(reader), reader.dimensions()) {}

  Reader reader;
  CurveWatch watch;
};

}  // namespace

nlohmann::json run_soak_producers(const std::vector<std::string>& streams, double rate,
                                  Time start) {
  raise_descriptor_limit();
  const MonotonicClock clock;
  const JointMotion motion(start);
  const Time interval{std::llround(1e9 / rate)};
  std::vector<SoakProducer> producers;
  producers.reserve(streams.size());
  for (std::size_t i = 0; i < streams.size(); ++i) {
    // Spread over the interval, as independent producers are.
    const Time offset = interval * static_cast<int>(i) / static_cast<int>(streams.size());
    producers.emplace_back(streams[i], start + offset, interval);
  }
  for (Time due = clock.now(); sleep_until(due); due = std::max(due, clock.now()) + kProducerTick) {
    for (SoakProducer& producer : producers) producer.tick(clock.now(), motion);
  }
  std::size_t sent = 0;
  std::size_t refused = 0;
  // The summary counts the items that were not solved by then.
  const Time end = clock.now() + kPatience;
  for (SoakProducer& producer : producers) (void)producer.finish(clock, end);
  for (SoakProducer& producer : producers) {
    (void)producer.wait_until_consumed(end - clock.now());
    sent += producer.sent();
    refused += producer.refused();
  }
  return {{"sent", sent}, {"refused", refused}};
}

nlohmann::json run_soak_reader(const std::vector<std::string>& streams) {
  raise_descriptor_limit();
  const MonotonicClock clock;
  std::vector<std::unique_ptr<WatchedStream>> watched;
  watched.reserve(streams.size());
  for (const std::string& stream : streams) {
    watched.push_back(std::make_unique<WatchedStream>(stream));
  }
  for (Time due = clock.now(); sleep_until(due); due = std::max(due, clock.now()) + kReaderTick) {
    for (auto& stream : watched) (void)stream->watch.tick(clock.now());
  }
  std::uint64_t samples = 0;
  std::uint64_t with_values = 0;
  std::uint64_t revised = 0;
  std::uint64_t changed = 0;
  std::uint64_t joins = 0;
  std::size_t unsound = 0;
  for (const auto& stream : watched) {
    const WatchReport& report = stream->watch.report();
    samples += report.samples;
    for (std::size_t i = 0; i < report.by_status.size(); ++i) {
      const auto status = static_cast<SampleStatus>(i);
      if (has_values(status)) with_values += report.by_status[i];
      if (status == SampleStatus::revised) revised += report.by_status[i];
    }
    changed += report.changed;
    joins += report.knots;
    if (!is_sound(report)) ++unsound;
  }
  return {{"samples", samples}, {"with_values", with_values},
          {"revised", revised}, {"changed", changed},
          {"joins", joins},     {"unsound_streams", unsound}};
}

}  // namespace splinecast::apps
