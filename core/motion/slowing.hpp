#pragma once

#include <span>

#include "splinecast/time.hpp"

/// Slowing down on a path: the same way, travelled at a rate that goes from 1 to 0.
namespace splinecast::core {

/// Lets a motion come to rest at the end of its path. The path is a curve x of a time s, which runs
/// from `begin` to `end`. It is travelled at the rate
///
///     r(t) = 1 − 3u² + 2u³,   u = (t − begin)/T,   T = 2(end − begin),
///
/// whose integral over T is end − begin: the motion rests at the path's end, end − begin after the
/// path's own time. A knot of the path at the time s gets the time t at which the motion is there,
/// the velocity x′r and the acceleration x″r² + x′ṙ. Between the knots the motion is a quintic
/// (SegmentForm::slowed), which meets the path at both its ends in position and in two derivatives.
/// Between its ends it may leave the path: the caller measures how far.
///
/// The knots follow from the path alone, with the same bits on every machine. Changes nothing,
/// throws nothing.
class Slowing {
 public:
  /// Requires begin < end, and that end_time() is a time.
  Slowing(Time begin, Time end) noexcept : begin_(begin), length_(2 * (end - begin)) {}

  [[nodiscard]] Time begin() const noexcept { return begin_; }

  /// When the motion is at rest at the end of the path.
  [[nodiscard]] Time end_time() const noexcept { return begin_ + length_; }

  /// The first whole nanosecond at which the motion has reached the path's time s, begin ≤ s ≤ end.
  /// Later for a later s, unless rounding makes two times equal. Halves an interval at most 63
  /// times.
  [[nodiscard]] Time time_of(Time s) const noexcept;

  /// How far the motion is on the path at time t, begin ≤ t ≤ end_time(): the path's time after its
  /// begin, in seconds.
  [[nodiscard]] double way_at(Time t) const noexcept;

  /// Writes the velocity and the acceleration at time t, from the path's velocity there and its
  /// accelerations before and after: where these differ, their mean counts. O(D).
  void write_state(Time t, std::span<const double> velocity, std::span<const double> before,
                   std::span<const double> after, std::span<double> slowed_velocity,
                   std::span<double> slowed_acceleration) const noexcept;

 private:
  Time begin_;
  Time length_;
};

}  // namespace splinecast::core
