#pragma once

#include <cstddef>
#include <span>

#include "core/polynomial/segment.hpp"
#include "splinecast/dimension_kind.hpp"
#include "splinecast/limits.hpp"
#include "splinecast/state.hpp"
#include "splinecast/time.hpp"
#include "splinecast/waypoint.hpp"

/// The stop segment: from a moving state to rest. Its speed never increases.
///
/// Its velocity is the cubic Hermite interpolant from (v, a₀) to (0, 0) over T. This is monotone,
/// without overshoot or reversal, if and only if a₀ is between 0 and −3v/T (Fritsch and Carlson
/// 1980); so a₀ is the given acceleration clamped to that interval, per dimension. Then no
/// dimension moves faster than at the start, nor further than |v|·T/2, and its deceleration peaks
/// at most at 3|v|/T (at 1.5|v|/T for a₀ = 0). The acceleration may step at the start of the stop.
///
/// A quaternion stops along the straight line of its velocity: a₀ is −λv in its four dimensions. So
/// it turns about one axis, and with it the rotation only slows down.
///
/// Spans hold one value per dimension. Every function is O(D), allocates nothing, throws nothing.
namespace splinecast::core {

/// Shortest stop after an entry that ends within a stop segment. Limits may need up to twice as
/// long.
inline constexpr Time kLeastStopTime{1'000'000};

/// The acceleration with which a stop of `seconds` > 0 begins.
[[nodiscard]] double stop_acceleration(double velocity, double acceleration,
                                       double seconds) noexcept;

/// Writes the stop that begins at `from` and takes `stop_length` > 0. Sets everything except
/// `acceleration_step`.
void build_stop(Time from, Time stop_length, std::span<const double> position,
                std::span<const double> velocity, std::span<const double> acceleration,
                Segment& out) noexcept;

/// What decides the length of a stop. A view.
struct StopRules {
  const MotionLimits& limits;  ///< lists of one value per dimension, or empty
  const DimensionKinds& kinds;
  Time stop_length;  ///< > 0: the length of a stop, unless limits or bounds change it
};

/// Replaces the acceleration of each quaternion by its part against the velocity: that with which
/// its stop begins, before it is clamped.
void align_rotations(const DimensionKinds& kinds, std::span<const double> velocity,
                     std::span<double> acceleration) noexcept;

/// The shortest time in which a stop respects the acceleration and jerk limit of every dimension; 0
/// without limits. A dimension that already decelerates beyond its limit gets 3|v|/limit, which
/// respects the limit from the first instant on. For a quaternion it is an estimate.
[[nodiscard]] Time least_stop_time(const MotionLimits& limits, const DimensionKinds& kinds,
                                   const Instant& from) noexcept;

/// Where dimension d rests after a stop of `length`. Monotone in the length: a longer stop goes
/// farther, in the direction of the velocity.
[[nodiscard]] double stop_position(const Instant& from, std::size_t d, Time length) noexcept;

/// The length of the stop from a state: the stop time, or as long as the limits need if that is
/// longer. A stop that would end beyond a bound of a dimension with a limit of acceleration is
/// shorter: the longest that ends within, but not shorter than the limits need. At least 1 ns. A
/// rotation so fast that no stop along a straight line keeps its limits gets the length of its
/// estimate. At most 62 bisections per dimension with bounds and 25 RotationBounds per quaternion
/// with limits; O(1) without limits of acceleration and jerk.
[[nodiscard]] Time stop_time_within(const StopRules& rules, const Instant& from) noexcept;

/// Whether a stop of this length ends beyond a bound of a dimension, in the direction of its
/// motion.
[[nodiscard]] bool stop_passes_bound(const MotionLimits& limits, const Instant& from, std::size_t d,
                                     Time length) noexcept;

/// Writes the stop from a state, its rotations aligned, with the length of `stop_time_within`, and
/// returns that length.
Time build_stop_within(const StopRules& rules, const Instant& from, Segment& out) noexcept;

}  // namespace splinecast::core
