#pragma once

namespace splinecast::campaign {

/// Largest allowed share of samples of a row, outside pauses, that hold.
inline constexpr double kMostHolding = 0.01;

/// The peaks of a motion over all of its dimensions.
struct Peaks {
  double velocity = 0;      ///< rad/s
  double acceleration = 0;  ///< rad/s²
};

/// The largest acceleration that a row without limits may show, with 10 % slack. It is the maximum
/// of: three times the peak of the motion; a stop from its peak velocity; if `largest_error` is
/// above 0.5 rad, a motion over this distance in 1 s.
[[nodiscard]] double most_without_limits(const Peaks& motion, double largest_error);

}  // namespace splinecast::campaign
