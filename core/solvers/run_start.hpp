#pragma once

#include <span>

#include "core/solvers/knot_ring.hpp"

namespace splinecast::core {

/// Writes the slope at the first knot of a run of the parabola through its first three waypoints;
/// of two it is the slope of their line, of one 0: from its waypoints alone, never from the curve
/// before it. O(D), allocates nothing and throws nothing.
void write_run_start(const KnotRing& knots, std::span<double> velocity) noexcept;

}  // namespace splinecast::core
