#pragma once

#include <span>

#include "splinecast/boundary_condition.hpp"
#include "splinecast/piecewise_polynomial.hpp"
#include "splinecast/waypoint.hpp"

namespace splinecast::core {

/// What the C² cubic spline's unknowns are. Both forms give the same curve to rounding.
enum class C2Form {
  velocity,      ///< knot velocities, by the rows of tridiagonal_system.hpp (doc 003 eq 4-9)
  acceleration,  ///< knot accelerations (doc 003 eq 4-10, 4-15)
};

/// The C² cubic spline through all waypoints at once, with any pairing of end conditions that makes
/// sense: `periodic` needs the other end periodic too, three waypoints, and a last position equal
/// to the first; `not-a-knot` needs three waypoints, four if both ends have it.
///
/// Only times and positions of the waypoints are used. One waypoint gives a hold, two a line, or
/// what their conditions ask for. Throws std::invalid_argument, with the reason, index and value,
/// for anything else. O(n·D).
[[nodiscard]] PiecewisePolynomial c2_spline(const Waypoints& waypoints, const Condition& start,
                                            const Condition& end, C2Form form = C2Form::velocity);

/// The same for times and positions [knot][dimension].
[[nodiscard]] PiecewisePolynomial c2_spline(std::span<const Time> times,
                                            std::span<const double> positions,
                                            std::size_t dimensions, const Condition& start,
                                            const Condition& end);

}  // namespace splinecast::core
