#pragma once

#include "apps/tables/waypoints.hpp"
#include "splinecast/time.hpp"

namespace splinecast::apps {

/// A synthetic recording: seven joint angles in rad of an arm that picks and places, at 100 Hz with
/// ±2 ms of jitter. Every joint moves between poses with minimum jerk, with a short dwell at each
/// pose. The same duration always gives the same waypoints.
[[nodiscard]] WaypointTable pick_and_place(Time duration);

}  // namespace splinecast::apps
