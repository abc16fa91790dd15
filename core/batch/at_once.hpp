#pragma once

#include "splinecast/boundary_condition.hpp"
#include "splinecast/piecewise_polynomial.hpp"
#include "splinecast/waypoint.hpp"

/// Methods with their own batch fit. Each throws std::invalid_argument as `fit` does. O(n·D).
namespace splinecast::core {

/// The C² cubic spline, with any boundary condition.
[[nodiscard]] PiecewisePolynomial fit_c2(const Waypoints& waypoints, const Condition& start,
                                         const Condition& end);

/// The C² cubic spline in a parameter that increases by 1 from waypoint to waypoint (math 14), with
/// natural ends. Each segment is then stretched to its real interval.
[[nodiscard]] PiecewisePolynomial fit_normalized(const Waypoints& waypoints, const Condition& start,
                                                 const Condition& end);

}  // namespace splinecast::core
