#pragma once

#include <vector>

#include "splinecast/core/piecewise_polynomial.hpp"
#include "splinecast/core/sliding_window.hpp"
#include "splinecast/core/waypoint.hpp"

namespace splinecast::testing {

/// Feeds waypoints through a window, finishes it, and keeps each segment as it was when it settled.
std::vector<core::Segment> settled_segments(const core::Waypoints& waypoints,
                                            const core::WindowOptions& how,
                                            const core::Condition& end);

/// The same as one curve.
core::PiecewisePolynomial online(const core::Waypoints& waypoints, const core::WindowOptions& how,
                                 const core::Condition& end);

}  // namespace splinecast::testing
