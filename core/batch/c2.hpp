#pragma once

#include <span>

#include "splinecast/boundary_condition.hpp"
#include "splinecast/piecewise_polynomial.hpp"
#include "splinecast/waypoint.hpp"

namespace splinecast::core {

/// The unknowns of the C² cubic spline. Both forms give the same curve to rounding.
enum class C2Form {
  velocity,      ///< knot velocities, by the rows of tridiagonal_system.hpp (math 4)
  acceleration,  ///< knot accelerations (math 5, 7)
};

/// The C² cubic spline through all waypoints at once, with any valid pair of boundary conditions:
/// `periodic` needs the other end periodic too, three waypoints, and a last position equal to the
/// first; `not-a-knot` needs three waypoints, four if both ends have it.
///
/// Uses only times and positions of the waypoints. One waypoint gives a hold, two a line or the
/// cubic that their conditions define. Throws std::invalid_argument, with the reason, index and
/// value, for invalid input. O(n·D).
[[nodiscard]] PiecewisePolynomial c2_spline(const Waypoints& waypoints, const Condition& start,
                                            const Condition& end, C2Form form = C2Form::velocity);

/// The same for times and positions [knot][dimension].
[[nodiscard]] PiecewisePolynomial c2_spline(std::span<const Time> times,
                                            std::span<const double> positions,
                                            std::size_t dimensions, const Condition& start,
                                            const Condition& end);

}  // namespace splinecast::core
