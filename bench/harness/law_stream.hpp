#pragma once

#include <memory>
#include <optional>
#include <string>

#include "bench/harness/bench_stream.hpp"
#include "splinecast/clock.hpp"
#include "splinecast/producer.hpp"
#include "splinecast/rate_commander.hpp"
#include "splinecast/solver.hpp"
#include "splinecast/time.hpp"

namespace splinecast::bench {

/// A finished live stream that follows a time law of a constant rate, solved in simulated time, so
/// that the law and the stream have settled until end(). Nothing writes to either afterwards.
class LawStream {
 public:
  static constexpr double kRate = 0.5;

  explicit LawStream(const Waypoints& waypoints);
  [[nodiscard]] const std::string& name() const { return name_; }

  /// Host times between which the waypoints are. The first one is about the host's time at which
  /// the stream was made.
  [[nodiscard]] Time begin() const { return begin_; }
  [[nodiscard]] Time end() const { return end_; }

 private:
  /// A clock that this object advances.
  class Simulated final : public Clock {
   public:
    [[nodiscard]] Time now() const noexcept override { return now_; }
    void advance(Time by) { now_ += by; }

   private:
    Time now_ = MonotonicClock().now();
  };

  void pass(Time time);
  void pass_waypoints(const Waypoints& waypoints);

  StreamName law_;
  StreamName name_;
  Simulated clock_;
  RateCommander commander_;
  Solver law_solver_;
  Solver solver_;
  Time begin_{};
  Time end_{};
};

}  // namespace splinecast::bench
