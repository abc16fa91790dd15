#pragma once

#include <span>

#include "core/polynomial/segment.hpp"
#include "splinecast/limits.hpp"
#include "splinecast/time.hpp"

/// The stop segment: from a moving state to rest, without ever speeding up.
///
/// Its velocity is the cubic Hermite interpolant from (v, a₀) to (0, 0) over T. That is monotone,
/// without overshoot or reversal, iff a₀ lies between 0 and −3v/T (Fritsch and Carlson 1980), so a₀
/// is the given acceleration clamped into that interval, per dimension. Then no dimension moves
/// faster than it did, nor further than |v|·T/2, and its deceleration peaks at most at 3|v|/T (at
/// 1.5|v|/T from a₀ = 0). The acceleration may step where the stop begins.
///
/// Spans hold one value per dimension. Every function is O(D), allocates nothing, throws nothing.
namespace splinecast::core {

/// Shortest stop behind an entry that ends within one.
inline constexpr Time kLeastStopTime{1'000'000};

/// The acceleration with which a stop of `seconds` > 0 begins.
[[nodiscard]] double stop_acceleration(double velocity, double acceleration,
                                       double seconds) noexcept;

/// Writes the stop that begins at `from` and takes `stop_time` > 0. Sets everything but
/// `acceleration_step`.
void build_stop(Time from, Time stop_time, std::span<const double> position,
                std::span<const double> velocity, std::span<const double> acceleration,
                Segment& out) noexcept;

/// The shortest stop, at least `least` long, in which every dimension keeps its acceleration and
/// jerk limit; `least` without limits. A dimension that decelerates beyond its limit already takes
/// 3|v|/limit, in which it decelerates by no more than the limit from the first instant on.
[[nodiscard]] Time stop_time_within(const MotionLimits& limits, Time least,
                                    std::span<const double> velocity,
                                    std::span<const double> acceleration) noexcept;

}  // namespace splinecast::core
