#pragma once

#include <cstddef>
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

}  // namespace splinecast
