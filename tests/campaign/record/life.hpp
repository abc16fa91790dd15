#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "splinecast/clock.hpp"
#include "splinecast/producer.hpp"
#include "splinecast/solver.hpp"
#include "splinecast/stopper.hpp"
#include "tests/campaign/record/source.hpp"
#include "tests/campaign/streams/random.hpp"

namespace splinecast::campaign::record {

/// What a stream keeps when its producer or its solver is replaced.
struct Shape {
  std::size_t dimensions = 1;
  std::size_t capacity = 1024;  ///< of the ring
  bool has_limits = false;
};

/// A stream with its producer and its solver, both in this thread, from its creation to the end of
/// its producer.
class Life {
 public:
  /// Creates the stream, or continues one that was not finished.
  Life(const SourcePlan& plan, const Shape& shape, Random& random);

  /// Sends until an instant of CLOCK_MONOTONIC.
  void run(Time end);
  void finish();
  /// What has been sent.
  [[nodiscard]] Sent sent() const;
  [[nodiscard]] bool is_finished() const noexcept { return is_finished_; }

 private:
  void send_live();
  void send_fast();
  void append_until(Time end);
  [[nodiscard]] bool append(Time time);
  void replace();
  void hold_or_release();
  void begin_solver();
  void step();
  [[nodiscard]] bool is_timed() const noexcept {
    return plan_.kind == SourceKind::live || plan_.kind == SourceKind::follower;
  }
  [[nodiscard]] Time first_time();

  const SourcePlan& plan_;
  const Shape shape_;
  Random& random_;
  MonotonicClock clock_;
  std::optional<Producer> producer_;
  std::optional<Solver> solver_;
  std::optional<Stopper> stopper_;
  bool is_stopped_ = false;
  bool is_finished_ = false;
  Time interval_{};
  Time next_{};  ///< time of the next waypoint
  std::vector<double> position_;
};

}  // namespace splinecast::campaign::record
