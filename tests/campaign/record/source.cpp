#include "tests/campaign/record/source.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>

#include "apps/process/signals.hpp"
#include "ipc/mapping/checked_region.hpp"
#include "ipc/ring/reader.hpp"
#include "splinecast/errors.hpp"
#include "splinecast/rate_commander.hpp"
#include "splinecast/streams.hpp"
#include "tests/campaign/record/life.hpp"

namespace splinecast::campaign::record {
namespace {

using std::chrono::milliseconds;

Shape shape_of(SourceKind kind, Random& random) {
  if (kind == SourceKind::wide) return {.dimensions = 64, .capacity = std::size_t{1} << 15U};
  constexpr std::size_t kLeastBits = 4;
  return {.dimensions = 1 + random.below(7),
          .capacity = std::size_t{1} << (kLeastBits + random.below(9)),
          .has_limits = random.chance(0.3)};
}

/// How a life ends.
enum class End : std::uint8_t { left, finished, removed, finished_and_removed };

/// The lives of a stream, one after the other.
class Source {
 public:
  explicit Source(const SourcePlan& plan) : plan_(plan), random_(plan.seed) {}

  std::vector<Sent> run() {
    const Time end = clock_.now() + plan_.length;
    await_law(end);
    while (clock_.now() < end && !apps::stop_requested()) live(end);
    if (!sent_.empty()) sent_.back().is_left = exists_;
    return sent_;
  }

 private:
  void await_law(Time end) {
    while (plan_.kind == SourceKind::follower && clock_.now() < end) {
      try {
        (void)ipc::open_board(plan_.law, false, {});
        return;
      } catch (const StreamError&) {  // its solver has not begun it yet
        (void)apps::sleep_until(clock_.now() + milliseconds(2));
      }
    }
  }

  void live(Time end) {
    if (!continues_) shape_ = shape_of(plan_.kind, random_);
    const auto how = static_cast<End>(random_.below(4));
    {
      Life life(plan_, shape_, random_);
      const Time length = random_.between(milliseconds(20), milliseconds(700));
      life.run(plan_.kind == SourceKind::wide ? end : std::min(end, clock_.now() + length));
      if (how == End::finished || how == End::finished_and_removed) life.finish();
      note(life.sent());
      continues_ = !life.is_finished();
    }
    exists_ = how == End::left || how == End::finished;
    if (exists_) return;
    remove_stream(plan_.stream);
    continues_ = false;
    (void)apps::sleep_until(clock_.now() + random_.between(Time::zero(), milliseconds(100)));
  }

  void note(const Sent& sent) {
    if (!sent_.empty() && sent_.back().id == sent.id) sent_.pop_back();
    sent_.push_back(sent);
  }

  const SourcePlan& plan_;
  Random random_;
  MonotonicClock clock_;
  Shape shape_;
  bool continues_ = false;  ///< the stream was not finished: the next life continues it
  bool exists_ = false;
  std::vector<Sent> sent_;
};

}  // namespace

nlohmann::json to_json(const std::vector<Sent>& sent) {
  nlohmann::json list = nlohmann::json::array();
  for (const Sent& one : sent) {
    list.push_back({one.stream, one.id, one.items,
                    one.segments ? nlohmann::json(*one.segments) : nullptr, one.is_left});
  }
  return list;
}

std::vector<Sent> sent_from(const nlohmann::json& json) {
  std::vector<Sent> sent;
  for (const auto& one : json) {
    Sent& last = sent.emplace_back(Sent{.stream = one[0], .id = one[1], .items = one[2]});
    if (!one[3].is_null()) last.segments = one[3].get<std::uint64_t>();
    last.is_left = one[4];
  }
  return sent;
}

double position_at(Time time, std::size_t dimension, bool is_replacement) noexcept {
  const double phase = to_seconds(time) * 3 + static_cast<double>(dimension);
  return is_replacement ? 0.7 * std::cos(phase) : std::sin(phase);
}

std::vector<Sent> run_source(const SourcePlan& plan) { return Source(plan).run(); }

std::vector<Sent> run_law(const std::string& law, std::uint64_t seed, Time length) {
  const MonotonicClock clock;
  Random random(seed);
  Solver solver(law, {});
  RateCommander commander(law, "campaign");
  const Time end = clock.now() + length;
  for (Time next = Time::min(); clock.now() < end && !apps::stop_requested();) {
    if (clock.now() >= next) {
      commander.set_rate(random.chance(0.2) ? 0 : random.unit(),
                         milliseconds(1 + random.below(100)));
      next = clock.now() + random.between(milliseconds(5), milliseconds(300));
    }
    if (!solver.attached()) (void)solver.attach(clock);
    (void)solver.step(clock);
    solver.wait(milliseconds(2));
  }
  const auto ring = ipc::open_ring(law, false, {});
  const ipc::WaypointRingReader reader(ring.region.bytes(), ring.layout);
  return {{.stream = law, .id = ring.header.stream_id, .items = reader.written(), .is_left = true}};
}

}  // namespace splinecast::campaign::record
