#pragma once

namespace splinecast::campaign {

/// Largest share of a row that may be held, besides the pauses.
inline constexpr double kMostHolding = 0.01;

/// The peaks of a motion over all of its dimensions.
struct Peaks {
  double velocity = 0;      ///< rad/s
  double acceleration = 0;  ///< rad/s²
};

/// The largest acceleration that a row without limits may show: three times the motion's own, that
/// of a stop from its peak velocity, or, where readers were `largest_error` rad away from the path,
/// that of a motion over the distance in a second.
[[nodiscard]] double most_without_limits(const Peaks& motion, double largest_error);

}  // namespace splinecast::campaign
