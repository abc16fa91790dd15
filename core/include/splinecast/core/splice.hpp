#pragma once

#include <span>

#include "splinecast/core/knot_ring.hpp"
#include "splinecast/core/segment.hpp"
#include "splinecast/core/time.hpp"

/// Splices: the order-6 segments by which a curve goes on from a given state, and the velocity at
/// the first waypoint of a run, which comes from its waypoints alone, never from the curve. Every
/// function is O(D), allocates nothing and throws nothing.
namespace splinecast::core {

/// A state at an instant. Spans hold one value per dimension; does not own them.
struct Instant {
  Time time{};
  std::span<const double> position;
  std::span<const double> velocity;
  std::span<const double> acceleration;
};

/// Writes the quintic from one state to a later one. Sets everything but `acceleration_step`.
void build_splice(const Instant& from, const Instant& to, Segment& out) noexcept;

/// Writes the slope at the first knot of a run of the parabola through its first three waypoints;
/// of two it is the slope of their line, of one 0.
void write_run_start(const KnotRing& knots, std::span<double> velocity) noexcept;

}  // namespace splinecast::core
