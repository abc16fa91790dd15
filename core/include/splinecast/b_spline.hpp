#pragma once

#include <cstddef>
#include <vector>

#include "splinecast/piecewise_polynomial.hpp"

namespace [[gnu::visibility("default")]] splinecast {

/// A curve as a B-spline: Σ P_i N_i(t), N_i over knots i … i + degree + 1.
struct BSpline {
  int degree = kCubicOrder - 1;        ///< 0 … kMaxPolynomialOrder − 1
  std::size_t dimensions = 0;          ///< D
  Time origin{};                       ///< time that the knots count from
  std::vector<Time> knots;             ///< n + degree + 1, from the origin; never decreasing
  std::vector<double> control_points;  ///< [i][dimension], n of them, in the unit of the positions
};

/// The B-spline of a curve, all of whose segments are raised to the highest order k. The first and
/// the last knot have multiplicity k; an interior break has degree − continuity(): for cubics 1
/// where they join C² (2 at a step of the acceleration, 3 at one of the velocity, 4 at one of the
/// position), for quintics 3 where they join C². Below degree 3 the continuity counts as at most
/// degree − 1. Exact to rounding.
///
/// Throws std::invalid_argument if the curve has no segment of positive length: the hold of a
/// single waypoint has no interval for a knot vector to span. O(n·k²·D); allocates.
[[nodiscard]] BSpline to_b_spline(const PiecewisePolynomial& curve);

/// The curve of a B-spline between its knots `degree` and n, a segment of order degree + 1 for each
/// interval that is not empty. Exact to rounding. Throws std::invalid_argument,
/// with index and value, for a degree out of range, knots that decrease or whose number does not go
/// with the control points, and if no interval is left. O(n·k²·(k + D)); allocates.
[[nodiscard]] PiecewisePolynomial from_b_spline(const BSpline& spline);

}  // namespace splinecast
