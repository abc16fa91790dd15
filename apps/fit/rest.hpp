#pragma once

#include <cstddef>

#include "core/online/sliding_window.hpp"
#include "ipc/layout/summary.hpp"
#include "splinecast/dimension_kind.hpp"
#include "splinecast/limits.hpp"
#include "splinecast/piecewise_polynomial.hpp"
#include "splinecast/waypoint.hpp"

namespace splinecast::apps {

/// What an end at rest must respect.
struct RestRules {
  MotionLimits limits{};  ///< lists of one value per dimension, or empty
  DimensionKinds kinds{};
  Time stop_length = core::WindowOptions{}.stop_length;  ///< > 0: see core::StopRules
};

/// A curve and how it ends.
struct FittedCurve {
  PiecewisePolynomial curve;
  ipc::EndKind end = ipc::EndKind::none;  ///< `none`: with a condition
  Time late{};  ///< how long after the time of its last waypoint it rests there
};

/// Lets a curve end at rest as a live stream does whose waypoints are all known in time. `halted`
/// ends in a full stop, `path` with the tail of a stream that continues; both go through the
/// waypoints, and differ at most in their last `open` segments. Takes the first of these that
/// exceeds no limit that the path keeps, and none by more than the path: `halted`; slowing down on
/// the path; an entry that rests at the last waypoint; the shortest stop after it. In a dimension
/// without a limit of acceleration that counts which the motion has shown (core::ShownLimits).
/// Slowing down and the entry begin at one of the last 1,024 waypoints. Allocates.
[[nodiscard]] FittedCurve rest_at_last(const PiecewisePolynomial& halted,
                                       const PiecewisePolynomial& path, const Waypoints& waypoints,
                                       const RestRules& rules, std::size_t open);

}  // namespace splinecast::apps
