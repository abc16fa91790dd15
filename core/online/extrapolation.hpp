#pragma once

#include <span>
#include <vector>

#include "core/forms/splice.hpp"
#include "core/online/sliding_window.hpp"
#include "core/polynomial/segment.hpp"
#include "splinecast/state.hpp"
#include "splinecast/time.hpp"

namespace splinecast::core {

/// What the target of an entry is behind the newest knot of a run: a straight line at the velocity
/// there, for as long as kLine, and then the stop. With a velocity limit the line keeps kLineShare
/// of it, per dimension, so that an entry can catch up. Allocates when made only; one thread uses
/// it.
class Extrapolation {
 public:
  static constexpr Time kLine{250'000'000};
  static constexpr double kLineShare = 0.8;

  explicit Extrapolation(std::size_t dimensions);

  /// Goes on from the newest knot of `target`; there must be one. O(D).
  void begin(const SlidingWindow& target) noexcept;

  /// When the line ends and the stop begins, and when the stop has come to rest.
  [[nodiscard]] Time line_end() const noexcept { return line_end_; }
  [[nodiscard]] Time rest() const noexcept { return stop_.right; }

  /// Writes position, velocity and acceleration at a time from the newest knot on. O(D).
  void state_at(Time t, const StateRef& out) const noexcept;

 private:
  Time begin_{};
  Time line_end_{};
  State from_;  ///< at the newest knot, at the line's velocity
  Segment stop_;
};

}  // namespace splinecast::core
