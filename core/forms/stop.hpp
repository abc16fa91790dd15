#pragma once

#include <span>

#include "core/polynomial/segment.hpp"
#include "splinecast/limits.hpp"
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
/// Spans hold one value per dimension. Every function is O(D), allocates nothing, throws nothing.
namespace splinecast::core {

/// Shortest stop after an entry that ends within a stop segment.
inline constexpr Time kLeastStopTime{1'000'000};

/// The acceleration with which a stop of `seconds` > 0 begins.
[[nodiscard]] double stop_acceleration(double velocity, double acceleration,
                                       double seconds) noexcept;

/// Writes the stop that begins at `from` and takes `stop_time` > 0. Sets everything except
/// `acceleration_step`.
void build_stop(Time from, Time stop_time, std::span<const double> position,
                std::span<const double> velocity, std::span<const double> acceleration,
                Segment& out) noexcept;

/// The length of the shortest stop, at least `least`, in which every dimension respects its
/// acceleration and jerk limit; `least` without limits. A dimension that already decelerates beyond
/// its limit gets 3|v|/limit, which respects the limit from the first instant on.
[[nodiscard]] Time stop_time_within(const MotionLimits& limits, Time least,
                                    std::span<const double> velocity,
                                    std::span<const double> acceleration) noexcept;

/// Writes the stop from a state with the length of `stop_time_within`, and returns that length.
Time build_stop_within(const MotionLimits& limits, Time least, const Instant& from,
                       Segment& out) noexcept;

}  // namespace splinecast::core
