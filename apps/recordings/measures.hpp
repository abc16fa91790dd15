#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "apps/tables/waypoints.hpp"
#include "splinecast/time.hpp"

/// Measures the intervals and the motion of a recording. All functions allocate.
namespace splinecast::apps {

/// Velocities are measured along chords of at least this duration.
inline constexpr Time kChord{50'000'000};

/// A gap is an interval of more than this many medians.
inline constexpr std::int64_t kGapFactor = 5;

/// The intervals between rows.
struct Intervals {
  Time median{};
  Time p5{};  ///< 5 % quantile
  Time p95{};
  Time largest{};
  Time jitter{};  ///< 95 % quantile of |interval − median|
  std::size_t gaps = 0;
  Time longest_gap{};  ///< 0 without gaps

  [[nodiscard]] Time gap_from() const noexcept { return saturated_product(median, kGapFactor); }
};

/// Measures the intervals between at least two increasing times.
[[nodiscard]] Intervals measure_intervals(std::span<const Time> times);

/// Measures at least one interval. `largest` may be that of a longer recording, of which these are
/// a part. Changes their order.
[[nodiscard]] Intervals measure_intervals(std::vector<Time>& intervals, Time largest);

/// The motion of one dimension, in its unit and seconds.
struct DimensionMotion {
  double noise = 0;          ///< standard deviation of noise and rounding of the positions
  double velocity = 0;       ///< 95 % quantile of the magnitudes, while the machine moves
  double peak_velocity = 0;  ///< largest magnitude
  double acceleration = 0;   ///< 95 % quantile, from second differences over two chords
  double peak_acceleration = 0;
};

/// Measures each dimension of a table whose times increase and whose angles and quaternions are
/// continuous. The noise follows from the median of third divided differences; on coarse recordings
/// the motion itself adds to it. No chord crosses a gap. Throws InputError if the rows between gaps
/// are too short for an acceleration.
[[nodiscard]] std::vector<DimensionMotion> measure_motion(const WaypointTable& table,
                                                          const Intervals& intervals);

}  // namespace splinecast::apps
