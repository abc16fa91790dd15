#include "tests/campaign/requests/stops.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <random>
#include <vector>

#include "apps/process/signals.hpp"
#include "ipc/board/named_board.hpp"
#include "ipc/owned/old_motion.hpp"
#include "splinecast/clock.hpp"
#include "splinecast/errors.hpp"
#include "splinecast/producer.hpp"
#include "splinecast/reader.hpp"
#include "splinecast/stopper.hpp"

namespace splinecast::campaign {
namespace {

using std::chrono::milliseconds;

/// After this time a request is lost.
/// A motion that is at rest moves by less than this.
constexpr double kRest = 1e-12;

/// One stopper of a stream.
class RandomStopper {
 public:
  RandomStopper(const std::string& stream, const std::string& name, std::uint64_t seed,
                RequestFacts& facts)
      : own_(stream, name), stream_(stream), facts_(facts), random_(seed) {
    if (!own_.is_latched()) return;
    ++facts_.stops_left;  // by a process that was killed
    watch(own_.stop(), clock_.now());
    release();
  }

  void act() {
    const Time made = clock_.now();
    watch(own_.stop(), made);
    release();
  }

 private:
  [[nodiscard]] std::int64_t below(std::int64_t end) {
    return std::uniform_int_distribution<std::int64_t>(0, end - 1)(random_);
  }

  /// Waits until a stop is in force, and then watches that the machine comes to rest and stays.
  void watch(std::uint64_t number, Time made) {
    if (!own_.wait_in_force(number, kLongestRequest)) {
      if (!apps::stop_requested()) ++facts_.lost_stops;
      return;
    }
    facts_.stopped.note(clock_.now() - made);
    ++facts_.stops;
    const Time rest = std::max(ipc::end_of_motion(stream_, {}), clock_.now());
    if (!apps::sleep_until(rest + Time(1))) return;
    std::vector<double> first;
    for (const Time end = clock_.now() + Time(below(40'000'000)); clock_.now() < end;) {
      look(first);
      if (!apps::sleep_until(clock_.now() + milliseconds(1))) return;
    }
  }

  /// Samples the stream. A position that differs from the first one is a motion in spite of a stop.
  void look(std::vector<double>& first) {
    try {
      Reader reader(stream_);
      State state(reader.dimensions());
      if (!has_values(reader.sample(clock_.now(), state))) return;
      ++facts_.looks_at_rest;
      const auto position = state.position();
      if (first.empty()) first.assign(position.begin(), position.end());
      const bool moves =
          std::abs(state.velocity()[0]) > kRest || std::abs(position[0] - first[0]) > kRest;
      if (moves) ++facts_.moved_while_held;
    } catch (const StreamError&) {
      return;  // the stream is being created again
    }
  }

  void release() {
    if (!own_.wait_in_force(own_.release(), kLongestRequest)) {
      if (!apps::stop_requested()) ++facts_.lost_stops;
      return;
    }
    ++facts_.stops_released;
  }

  Stopper own_;
  std::string stream_;
  RequestFacts& facts_;
  std::mt19937_64 random_;
  MonotonicClock clock_;
};

/// A producer of a swing around the place where the machine is.
class Swing {
 public:
  Swing(const std::string& stream, std::uint64_t seed, RequestFacts& facts)
      : producer_(stream, {.dimensions = 1}), facts_(facts), random_(seed) {
    const Instant left = producer_.old_end();
    if (!left.position.empty()) center_ = left.position[0];
  }

  /// Sends the waypoints that are due. Returns false when the stream has been finished.
  bool act() {
    const Time now = clock_.now();
    if (next_ < now + milliseconds(20)) next_ = now + milliseconds(120);
    for (; next_ < now + milliseconds(150); next_ += milliseconds(10)) {
      if (!begin_) begin_ = next_;
      const double x = center_ + 0.1 * (1 - std::cos(3 * to_seconds(next_ - *begin_)));
      const AppendStatus status = producer_.append({.time = next_, .position = {&x, 1}});
      if (status == AppendStatus::stopped) ++facts_.appends_stopped;
      if (status != AppendStatus::accepted) break;
    }
    constexpr std::int64_t kRare = 150;
    if (std::uniform_int_distribution<std::int64_t>(0, kRare)(random_) > 0) return true;
    ++facts_.streams_created;
    if (producer_.finish() != AppendStatus::accepted) return true;
    (void)producer_.wait_until_consumed(kLongestRequest);
    return false;
  }

 private:
  Producer producer_;
  RequestFacts& facts_;
  std::mt19937_64 random_;
  MonotonicClock clock_;
  double center_ = 0;
  std::optional<Time> begin_{};
  Time next_{};
};

}  // namespace

void run_stopped_producer(const std::string& stream, std::uint64_t seed, RequestFacts& facts) {
  const MonotonicClock clock;
  std::mt19937_64 random(seed);
  std::optional<Swing> swing;
  while (apps::sleep_until(clock.now() + milliseconds(5))) {
    try {
      if (!swing) swing.emplace(stream, random(), facts);
      if (!swing->act()) swing.reset();
    } catch (const StreamBusy&) {
      continue;  // the killed one has just died
    }
  }
}

void run_stopper(const std::string& stream, const std::string& name, std::uint64_t seed,
                 RequestFacts& facts) {
  const MonotonicClock clock;
  std::mt19937_64 random(seed + 1);
  RandomStopper stopper(stream, name, seed, facts);
  while (!apps::stop_requested()) {
    const Time pause(std::uniform_int_distribution<std::int64_t>(0, 60'000'000)(random));
    if (apps::sleep_until(clock.now() + pause)) stopper.act();
  }
}

}  // namespace splinecast::campaign
