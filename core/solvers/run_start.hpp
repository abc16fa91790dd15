#pragma once

#include <span>

#include "core/solvers/knot_ring.hpp"

namespace splinecast::core {

/// Writes the slope at the first knot of a run: that of the parabola through its first three
/// waypoints; with two waypoints that of their line, with one 0. It depends only on the waypoints
/// of the run, never on the curve before it. O(D), allocates nothing and throws nothing.
void write_run_start(const KnotRing& knots, std::span<double> velocity) noexcept;

}  // namespace splinecast::core
