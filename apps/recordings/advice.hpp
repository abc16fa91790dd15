#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "apps/recordings/measures.hpp"
#include "apps/tables/waypoints.hpp"
#include "splinecast/time.hpp"

/// Recommends lead, settle lag, stop time and limits for a recording, and predicts the effect of a
/// silence of its producer. Pure arithmetic; functions that return vectors allocate.
namespace splinecast::apps {

/// The least recommended lead, and a short lead for comparison.
inline constexpr Time kLeastLead{200'000'000};
inline constexpr Time kShortLead{60'000'000};

/// Ratio of the recommended limits to the 95 % quantiles of the motion.
inline constexpr double kLimitFactor = 3;

/// Options of the solver of a live stream.
struct SolvedHow {
  std::size_t settle = 8;
  Time settle_ahead{5'000'000};
};

/// The depth (time from now to the newest knot) that gives each knot `settle` newer knots before it
/// is frozen.
[[nodiscard]] Time depth_needed(Time interval, const SolvedHow& how) noexcept;

/// The same, but at most the depth that a recording of this length allows. The length of a stream
/// that continues is Time::max().
[[nodiscard]] Time depth_needed(Time interval, Time length, const SolvedHow& how) noexcept;

/// The lead for a recording of this length: the depth needed plus the jitter, rounded up to whole
/// milliseconds, at least kLeastLead.
[[nodiscard]] Time advised_lead(const Intervals& intervals, Time length,
                                const SolvedHow& how) noexcept;

/// The recommended settle lag: 8, or down to 4 if 8 needs a lead of more than 1 s.
[[nodiscard]] std::size_t advised_settle(const Intervals& intervals, Time settle_ahead) noexcept;

/// Limits of each dimension, and a stop time that keeps them.
struct AdvisedLimits {
  std::vector<double> velocity{};
  std::vector<double> acceleration{};  ///< a stop from the peak velocity takes at most 1 s
  Time stop_length{};
};
[[nodiscard]] AdvisedLimits advised_limits(std::span<const DimensionMotion> motion);

/// The effect of a silence of the producer on a live stream.
struct SilenceEffect {
  Time lead{};
  Time silence{};
  Time depth_left{};           ///< just before the next waypoint of the producer
  Time dry{};                  ///< time for which readers follow the stop segment
  bool comes_to_rest = false;  ///< whether the stop segment ends before the next waypoint
  /// Time in s to return onto the path, for each dimension at its peak velocity; nothing if the
  /// limits leave no velocity to catch up.
  std::vector<std::optional<double>> return_time{};
};

/// Predicts the effect of a silence in the worst case: it starts just before a waypoint is due. The
/// return is a minimum-time motion within the limits, while the path continues at the peak
/// velocity.
[[nodiscard]] SilenceEffect foresee(Time lead, Time silence, Time interval, Time settle_ahead,
                                    std::span<const DimensionMotion> motion,
                                    const AdvisedLimits& limits);

/// The recommendations for a recording.
struct Advice {
  Intervals intervals{};
  std::vector<DimensionMotion> motion{};
  SolvedHow how{};
  Time depth_needed{};
  Time lead{};
  AdvisedLimits limits{};
  std::vector<SilenceEffect>
      silences{};  ///< silences of 100 and 300 ms, with `lead` and kShortLead
};

/// Recommendations for a table, see measure_motion(). With `continues` the stream continues after
/// the table. Chooses the settle lag if it is not given. Throws InputError for too few rows.
[[nodiscard]] Advice advise(const WaypointTable& table, Time settle_ahead,
                            std::optional<std::size_t> settle, bool continues);

}  // namespace splinecast::apps
