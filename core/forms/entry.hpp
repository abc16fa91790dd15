#pragma once

#include <span>

#include "core/polynomial/segment.hpp"
#include "splinecast/waypoint.hpp"

/// Entries: segments of order 6 from a given state onto the waypoints. Every function is O(D),
/// allocates nothing and throws nothing.
namespace splinecast::core {

/// Shortest time in seconds of an entry from rest to rest over a distance ≥ 0 within limits of
/// velocity, acceleration and jerk, each 0: none.
[[nodiscard]] double seconds_from_rest(double distance, double velocity, double acceleration,
                                       double jerk) noexcept;

/// Writes the quintic from one state to a later one. Sets everything except `acceleration_step`.
void build_entry(const Instant& from, const Instant& to, Segment& out) noexcept;

}  // namespace splinecast::core
