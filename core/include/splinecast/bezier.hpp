#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "splinecast/piecewise_polynomial.hpp"

namespace [[gnu::visibility("default")]] splinecast {

/// A segment given by its control points: `order` of them, the first and the last on the curve. The
/// curve is inside their convex hull.
struct BezierSegment {
  Time left{};
  Time right{};
  int order = kCubicOrder;
  std::vector<double> control_points;  ///< [point][dimension], in the unit of the positions
};

/// The control points of every segment, each at its own order; exact to rounding. All control
/// points of a hold are its position. O(n·k²·D); allocates.
[[nodiscard]] std::vector<BezierSegment> to_bezier(const PiecewisePolynomial& curve);

/// Converts consecutive Bézier segments to a curve. Exact to rounding. The r-th derivative is a
/// difference of positions divided by h^r: it loses digits if the positions are large compared with
/// their changes. A segment of zero length must be the only one; it holds its first control point.
/// Throws std::invalid_argument as PiecewisePolynomial::append does. O(n·k²·D); allocates.
[[nodiscard]] PiecewisePolynomial from_bezier(std::size_t dimensions,
                                              std::span<const BezierSegment> segments);

}  // namespace splinecast
