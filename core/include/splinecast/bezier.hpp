#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "splinecast/piecewise_polynomial.hpp"

namespace [[gnu::visibility("default")]] splinecast {

/// A segment by its control points: as many as its order, the first and the last on the curve,
/// which lies within their convex hull.
struct BezierSegment {
  Time left{};
  Time right{};
  int order = kCubicOrder;
  std::vector<double> control_points;  ///< [point][dimension], in the unit of the positions
};

/// The control points of every segment, each at its own order; exact to rounding. All those of a
/// hold lie on it. O(n·k²·D); allocates.
[[nodiscard]] std::vector<BezierSegment> to_bezier(const PiecewisePolynomial& curve);

/// The curve of consecutive segments. Exact to rounding; the r-th derivative is a difference of
/// positions divided by h^r, so that a curve whose positions are large compared with its moves
/// loses digits of it. A segment of no length must stand alone and holds its first control point.
/// Throws std::invalid_argument as PiecewisePolynomial::append does. O(n·k²·D); allocates.
[[nodiscard]] PiecewisePolynomial from_bezier(std::size_t dimensions,
                                              std::span<const BezierSegment> segments);

}  // namespace splinecast
