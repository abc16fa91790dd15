#pragma once

#include <span>
#include <vector>

#include "core/forms/entry.hpp"
#include "core/online/sliding_window.hpp"
#include "core/polynomial/segment.hpp"
#include "splinecast/state.hpp"
#include "splinecast/time.hpp"

namespace splinecast::core {

/// The target of an entry after the newest knot of a run: a straight line with the velocity at that
/// knot, of length kLineLength, then the stop segment. The velocity of the line is at most
/// kLineShare of the velocity limit, per dimension, so that an entry can reach the line. Only the
/// constructor allocates. Not thread-safe: one thread uses it.
class Extrapolation {
 public:
  static constexpr Time kLineLength{250'000'000};
  static constexpr double kLineShare = 0.8;

  explicit Extrapolation(std::size_t dimensions);

  /// Starts at the newest knot of `target`; there must be one. O(D).
  void begin(const SlidingWindow& target) noexcept;

  /// The same in two steps, to choose the length of the stop, > 0.
  void begin_line(const SlidingWindow& target) noexcept;
  void stop_after(Time length) noexcept;

  /// The state at the end of the line.
  [[nodiscard]] Instant line_end_state() const noexcept {
    return {line_end_, to_.position(), to_.velocity(), to_.acceleration()};
  }

  /// The end of the line, where the stop segment begins, and the end of the stop segment.
  [[nodiscard]] Time line_end() const noexcept { return line_end_; }
  [[nodiscard]] Time rest() const noexcept { return stop_.right; }

  /// Writes position, velocity and acceleration at a time at or after the newest knot. O(D).
  void state_at(Time t, const StateRef& out) const noexcept;

 private:
  Time begin_{};
  Time line_end_{};
  State from_;  ///< at the newest knot, with the velocity of the line
  State to_;    ///< at the end of the line
  Segment stop_;
};

}  // namespace splinecast::core
