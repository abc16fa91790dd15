#pragma once

#include <cstddef>

#include "splinecast/piecewise_polynomial.hpp"

namespace splinecast::core {

/// The continuity of a curve at the left break of a segment, 1 ≤ `segment` < segments(), over all
/// dimensions: 2 if position, velocity and acceleration are continuous, 1 if position and velocity
/// are, 0 if only the position is, −1 if the position jumps. At most 2. O(k·D); allocates D values.
///
/// A jump of the r-th derivative is ignored if it is within the rounding of the terms of the
/// derivative: 128·2⁻⁵² of Σ|c_k|h^k / h^r over the terms of both sides; for r > 0 without the
/// position c_0, because slopes come from differences of positions. So a C² spline is C² for any
/// ratio of neighbouring intervals, and an acceleration step is detected down to about 1e-13 of the
/// velocity divided by the shorter interval. A curve converted from control points may count as
/// less smooth: its slopes have the rounding of whole positions.
[[nodiscard]] int continuity(const PiecewisePolynomial& curve, std::size_t segment);

}  // namespace splinecast::core
