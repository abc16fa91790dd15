#pragma once

#include "core/solvers/knot_ring.hpp"
#include "splinecast/method.hpp"
#include "splinecast/piecewise_polynomial.hpp"
#include "splinecast/waypoint.hpp"

/// What the solvers that see all waypoints at once share.
namespace splinecast::core {

/// Throws std::invalid_argument, with index and value, unless a spline can be laid through the
/// waypoints' times and positions.
void require_waypoints(const Waypoints& waypoints);

/// Throws likewise, unless `values` has one finite value per waypoint and dimension.
void require_values_of(const Waypoints& waypoints, std::span<const double> values,
                       const char* what);

/// All waypoints as knots with their intervals measured, not solved; for a method that asks for
/// nothing else.
[[nodiscard]] KnotRing measure_knots(const Waypoints& waypoints, bool halts_at_start);

/// All waypoints as knots, solved by a method that streams.
[[nodiscard]] KnotRing solve_knots(const Waypoints& waypoints, const Interpolant& how,
                                   const Condition& start, const Condition& end);

/// The segments between solved knots.
[[nodiscard]] PiecewisePolynomial curve_of(const KnotRing& knots);

/// A hold at the first waypoint.
[[nodiscard]] PiecewisePolynomial hold_at(const Waypoints& waypoints);

/// The C² cubic spline by its acceleration form. The conditions' pairing must have been checked.
[[nodiscard]] PiecewisePolynomial c2_by_accelerations(const Waypoints& waypoints,
                                                      const Condition& start, const Condition& end);

}  // namespace splinecast::core
