#pragma once

#include "core/solvers/knot_ring.hpp"
#include "splinecast/method.hpp"
#include "splinecast/piecewise_polynomial.hpp"
#include "splinecast/waypoint.hpp"

/// Functions that the batch solvers share.
namespace splinecast::core {

/// Throws std::invalid_argument, with index and value, unless the times and positions of the
/// waypoints are valid for a spline.
void require_waypoints(const Waypoints& waypoints);

/// Throws in the same way unless `values` has one finite value per waypoint and dimension.
void require_values_of(const Waypoints& waypoints, std::span<const double> values,
                       const char* what);

/// All waypoints as knots with measured intervals, not solved. Stores the values that `c2` needs.
[[nodiscard]] KnotRing measure_knots(const Waypoints& waypoints, bool halts_at_start);

/// All waypoints as knots, solved by a method that streams.
[[nodiscard]] KnotRing solve_knots(const Waypoints& waypoints, const Interpolant& how,
                                   const Condition& start, const Condition& end);

/// The segments between solved knots.
[[nodiscard]] PiecewisePolynomial curve_of(const KnotRing& knots);

/// A hold at the first waypoint.
[[nodiscard]] PiecewisePolynomial hold_at(const Waypoints& waypoints);

/// The C² cubic spline by its acceleration form. The pair of conditions must have been checked.
[[nodiscard]] PiecewisePolynomial c2_by_accelerations(const Waypoints& waypoints,
                                                      const Condition& start, const Condition& end);

}  // namespace splinecast::core
