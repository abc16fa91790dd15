#pragma once

#include <span>

#include "core/polynomial/segment.hpp"
#include "splinecast/waypoint.hpp"

/// Entries: segments of order 6 from a given state onto the waypoints. Every function is O(D),
/// allocates nothing and throws nothing.
namespace splinecast::core {

/// Writes the quintic from one state to a later one. Sets everything except `acceleration_step`.
void build_entry(const Instant& from, const Instant& to, Segment& out) noexcept;

}  // namespace splinecast::core
