#include "apps/demo/chaos_producer.hpp"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <random>
#include <span>
#include <vector>

#include "apps/process/signals.hpp"
#include "apps/trials/joint_motion.hpp"
#include "core/forms/stop.hpp"
#include "core/polynomial/segment.hpp"
#include "splinecast/producer.hpp"
#include "splinecast/state.hpp"

namespace splinecast::apps {
namespace {

using std::chrono::milliseconds;

constexpr Time kTick = milliseconds(1);
constexpr Time kInterval = milliseconds(10);
/// The lead of waypoints in motion, the lead after a stop, when the machine must catch up with the
/// motion, and the duration of the last stop.
constexpr Time kLead = milliseconds(150);
constexpr Time kCatchUp = milliseconds(800);
constexpr Time kStop = milliseconds(800);
/// Mean number per second.
constexpr double kStarvations = 0.7;
constexpr double kReplacements = 1.7;

class ChaosProducer {
 public:
  ChaosProducer(const std::string& stream, Time start)
      : motion_(start),
        producer_(stream, {.dimensions = JointMotion::kJoints,
                           .limits = {.min_interval = milliseconds(5)}}),
        random_(static_cast<std::uint64_t>(getpid())),
        next_(start) {
    // A producer that takes over has to catch up as well.
    if (producer_.continues()) {
      lead_ = kCatchUp;
    } else {
      const std::vector<double> x = motion_.at(start);
      (void)producer_.start_from({.time = start, .position = x}, {.moved = true});
    }
  }

  nlohmann::json run() {
    Time due = clock_.now();
    while (sleep_until(due)) {
      due += kTick;
      tick();
    }
    finish();
    return {{"sent", sent_}, {"starved", starved_}, {"replaced", replaced_}};
  }

 private:
  bool happens(double per_second) {
    return std::uniform_real_distribution<double>(0, 1)(random_) < per_second * to_seconds(kTick);
  }
  Time between(int low, int high) {
    return milliseconds(std::uniform_int_distribution<int>(low, high)(random_));
  }

  void tick() {
    const Time now = clock_.now();
    if (now < silent_until_) return;
    if (happens(kStarvations)) {
      ++starved_;
      silent_until_ = now + lead_ + between(50, 300);
      lead_ = kCatchUp;
      return;
    }
    if (happens(kReplacements)) return replace(now);
    if (happens(1)) lead_ = kLead;
    skip_past(now);
    while (next_ - lead_ <= now) {
      send(next_, motion_.at(next_));
      next_ += kInterval;
    }
  }

  void skip_past(Time now) {
    const Time earliest = std::max(
        {now + kInterval, producer_.last_time() + kInterval, producer_.earliest() + kInterval});
    while (next_ < earliest) next_ += kInterval;
  }

  void send(Time t, const std::vector<double>& x) {
    if (producer_.append({.time = t, .position = x}) == AppendStatus::accepted) ++sent_;
  }

  /// Replaces the future, from 5 to 100 ms from now on, with waypoints of the same motion or with
  /// none: a halt.
  void replace(Time now) {
    const Time t = std::max(now, producer_.earliest()) + between(5, 100);
    const auto count = std::uniform_int_distribution<std::size_t>(0, 20)(random_);
    std::vector<std::vector<double>> positions;
    std::vector<Waypoint> waypoints;
    for (std::size_t i = 1; i <= count; ++i) {
      positions.push_back(motion_.at(t + kInterval * static_cast<int>(i)));
    }
    for (std::size_t i = 1; i <= count; ++i) {
      waypoints.push_back(
          {.time = t + kInterval * static_cast<int>(i), .position = positions[i - 1]});
    }
    if (producer_.replace_from(t, waypoints) != AppendStatus::accepted) return;
    ++replaced_;
    sent_ += count;
    lead_ = kCatchUp;
    next_ = producer_.last_time() + kInterval;
  }

  void finish() {
    skip_past(clock_.now() + kCatchUp);
    core::Segment stop(JointMotion::kJoints);
    core::build_stop(next_, kStop, motion_.at(next_), motion_.at(next_, 1), motion_.at(next_, 2),
                     stop);
    State state(JointMotion::kJoints);
    for (Time t = next_; t <= next_ + kStop; t += kInterval) {
      core::evaluate(stop.order, stop.coefficients, to_seconds(t - next_), state.ref());
      send(t, {state.position().begin(), state.position().end()});
    }
    constexpr Time kPatience = std::chrono::seconds(10);
    const Condition halt{.kind = ConditionKind::halt, .value = {}};
    while (producer_.finish(halt) == AppendStatus::full) {
      if (!producer_.wait_for_room(kPatience)) return;
    }
    (void)producer_.wait_until_consumed(kPatience);  // the summary counts what was not
  }

  JointMotion motion_;
  MonotonicClock clock_;
  Producer producer_;
  std::mt19937_64 random_;
  Time next_;
  Time lead_ = kLead;
  Time silent_until_{};
  std::size_t sent_ = 0;
  std::size_t starved_ = 0;
  std::size_t replaced_ = 0;
};

}  // namespace

nlohmann::json run_chaos_producer(const std::string& stream, Time start) {
  return ChaosProducer(stream, start).run();
}

}  // namespace splinecast::apps
