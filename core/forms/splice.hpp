#pragma once

#include <span>

#include "core/polynomial/segment.hpp"
#include "splinecast/waypoint.hpp"

/// Splices: the order-6 segments by which a curve goes on from a given state. Every function is
/// O(D), allocates nothing and throws nothing.
namespace splinecast::core {

/// Writes the quintic from one state to a later one. Sets everything but `acceleration_step`.
void build_splice(const Instant& from, const Instant& to, Segment& out) noexcept;

}  // namespace splinecast::core
