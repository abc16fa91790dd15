#pragma once

#include <cstddef>
#include <vector>

#include "splinecast/piecewise_polynomial.hpp"

namespace [[gnu::visibility("default")]] splinecast {

/// A curve as a B-spline: Σ P_i N_i(t), N_i over knots i … i + degree + 1.
struct BSpline {
  int degree = kCubicOrder - 1;        ///< 0 … kMaxPolynomialOrder − 1
  std::size_t dimensions = 0;          ///< D
  Time origin{};                       ///< zero of the knot times
  std::vector<Time> knots;             ///< n + degree + 1, relative to `origin`; non-decreasing
  std::vector<double> control_points;  ///< [i][dimension], n of them, in the unit of the positions
};

/// Converts a curve to a B-spline, with all segments raised to the highest order k. The first and
/// the last knot have multiplicity k. An interior break has multiplicity degree − continuity(): for
/// cubics 1 at a C² break (2 at a step of the acceleration, 3 at one of the velocity, 4 at one of
/// the position), for quintics 3 at a C² break. Below degree 3, continuity() counts as at most
/// degree − 1. Exact to rounding.
///
/// Throws std::invalid_argument if the curve has no segment of positive length: the hold of a
/// single waypoint has no interval for a knot vector. O(n·k²·D); allocates.
[[nodiscard]] BSpline to_b_spline(const PiecewisePolynomial& curve);

}  // namespace splinecast
