#pragma once

#include <span>

#include "splinecast/core/segment.hpp"
#include "splinecast/core/time.hpp"

/// Acceleration limits: what the segments that this library chooses itself (stop tails, splices)
/// keep to. A limit of 0 is none; spans hold one value per dimension, and no limits at all are an
/// empty span. Every function is O(D), allocates nothing and throws nothing.
namespace splinecast::core {

/// Shortest time in which anything is brought to rest.
inline constexpr Time kLeastStopTime{1'000'000};

/// The time in which a stop tail from this velocity and acceleration comes to rest such that no
/// dimension's acceleration passes its limit, or that which it begins with; at least `least`. With
/// a = 0 it is 1.5·|v|/limit.
[[nodiscard]] Time stop_time_within(std::span<const double> limits, Time least,
                                    std::span<const double> velocity,
                                    std::span<const double> acceleration) noexcept;

/// The time of a splice from rest to rest over `distance` per dimension within limits; at least
/// `least`. Its acceleration peaks at 10/√3·distance/time².
[[nodiscard]] Time move_time_within(std::span<const double> limits, Time least,
                                    std::span<const double> distance) noexcept;

/// The largest absolute acceleration of a segment in dimension d: in closed form, from its ends and
/// the zeros of its jerk.
[[nodiscard]] double peak_acceleration(const Segment& segment, std::size_t dimensions,
                                       std::size_t d) noexcept;

/// The largest ratio of a segment's acceleration to its dimension's limit; 0 without limits.
[[nodiscard]] double acceleration_excess(std::span<const double> limits,
                                         const Segment& segment) noexcept;

/// Whether a segment keeps within limits; what it begins with may be beyond them.
[[nodiscard]] bool keeps_within(std::span<const double> limits, const Segment& segment) noexcept;

}  // namespace splinecast::core
