#pragma once

#include <span>

#include "splinecast/core/condition.hpp"
#include "splinecast/core/piecewise_polynomial.hpp"
#include "splinecast/core/time.hpp"

namespace splinecast::core {

/// The C² cubic spline through all waypoints at once, by the rows of tridiagonal.hpp.
///
/// `times`: n ≥ 1 strictly increasing knot times. `positions`: n·dimensions finite values,
/// [knot][dimension]. One waypoint gives a hold, two a line, or what their conditions ask for.
/// Throws std::invalid_argument, with index and value, for anything else. O(n·D).
[[nodiscard]] PiecewisePolynomial c2_spline(std::span<const Time> times,
                                            std::span<const double> positions,
                                            std::size_t dimensions, const Condition& start,
                                            const Condition& end);

}  // namespace splinecast::core
