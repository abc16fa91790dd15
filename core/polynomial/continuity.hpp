#pragma once

#include <cstddef>

#include "splinecast/piecewise_polynomial.hpp"

namespace splinecast::core {

/// How smooth a curve is at the left break of a segment, 1 ≤ `segment` < segments(), over all its
/// dimensions: 2 if position, velocity and acceleration go on, 1 and 0 likewise, −1 if the position
/// itself jumps. No higher than 2. O(k·D); allocates D values.
///
/// A jump of the r-th derivative counts as none where it is no more than the rounding of what the
/// derivative was computed from: 128·2⁻⁵² of Σ|c_k|h^k / h^r over the terms of both sides; for
/// r > 0 without the position c_0, since slopes come from differences of positions. So a C² spline
/// is C² however much neighbouring intervals differ, and an acceleration step is one down to about
/// 1e-13 of the velocity divided by the shorter interval. A curve that was recovered from control
/// points may count as less smooth: its slopes carry the rounding of whole positions.
[[nodiscard]] int continuity(const PiecewisePolynomial& curve, std::size_t segment);

}  // namespace splinecast::core
