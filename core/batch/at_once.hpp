#pragma once

#include "splinecast/boundary_condition.hpp"
#include "splinecast/piecewise_polynomial.hpp"
#include "splinecast/waypoint.hpp"

/// Methods that make their curve of all waypoints at once in a way of their own. Each throws
/// std::invalid_argument as `fit` does. O(n·D).
namespace splinecast::core {

/// The C² cubic spline, which meets every condition.
[[nodiscard]] PiecewisePolynomial fit_c2(const Waypoints& waypoints, const Condition& start,
                                         const Condition& end);

/// The C² cubic spline in a parameter that grows by 1 from waypoint to waypoint (doc 002), each
/// segment then stretched over its real interval. Ends naturally.
[[nodiscard]] PiecewisePolynomial fit_normalized(const Waypoints& waypoints, const Condition& start,
                                                 const Condition& end);

}  // namespace splinecast::core
