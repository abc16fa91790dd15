#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "apps/recordings/measures.hpp"
#include "apps/tables/waypoints.hpp"
#include "splinecast/time.hpp"

/// Which lead, settle lag, stop time and limits follow from what a recording shows, and what a
/// silence of its producer does. Pure arithmetic; what returns vectors allocates.
namespace splinecast::apps {

/// The lead that is given where nothing asks for more, and a short one to compare it with.
inline constexpr Time kLeastLead{200'000'000};
inline constexpr Time kShortLead{60'000'000};

/// Limits are this many times the 95 % quantile of what the motion shows.
inline constexpr double kLimitFactor = 3;

/// How a solver treats a live stream.
struct SolvedHow {
  std::size_t settle = 8;
  Time freeze_ahead{5'000'000};
};

/// The depth with which each knot sees `settle` newer ones before it is frozen.
[[nodiscard]] Time depth_needed(Time interval, const SolvedHow& how) noexcept;

/// That depth, but no more than a recording of this length (max(): a stream that goes on) has.
[[nodiscard]] Time depth_needed(Time interval, Time length, const SolvedHow& how) noexcept;

/// The lead for a recording of this length: the depth needed and the jitter; in whole milliseconds,
/// at least kLeastLead.
[[nodiscard]] Time advised_lead(const Intervals& intervals, Time length,
                                const SolvedHow& how) noexcept;

/// The settle lag to recommend: 8, or fewer, at least 4, where 8 would need a lead of more than 1
/// s.
[[nodiscard]] std::size_t advised_settle(const Intervals& intervals, Time freeze_ahead) noexcept;

/// Limits of each dimension, and the length of a stop that keeps them.
struct AdvisedLimits {
  std::vector<double> velocity{};
  std::vector<double> acceleration{};  ///< such that a stop from a peak velocity takes 1 s at most
  Time stop_time{};
};
[[nodiscard]] AdvisedLimits advised_limits(std::span<const DimensionMotion> motion);

/// What a silence of the producer does to a live stream.
struct Hiccup {
  Time lead{};
  Time silence{};
  Time depth_left{};           ///< when the producer sends again, before what it sends
  Time dry{};                  ///< how long readers follow the stop segment
  bool comes_to_rest = false;  ///< before the next waypoint is entered
  /// Seconds from there back onto the path, for each dimension at its peak velocity; nothing where
  /// the limits leave no speed to catch up with.
  std::vector<std::optional<double>> way_back{};
};

/// Foresees a silence, in the worst case: it begins just before a waypoint is due. The way back is
/// a motion of minimum time within the limits, while the path goes on at the peak velocity.
[[nodiscard]] Hiccup foresee(Time lead, Time silence, Time interval, Time freeze_ahead,
                             std::span<const DimensionMotion> motion, const AdvisedLimits& limits);

/// What is to be said about a recording.
struct Advice {
  Intervals intervals{};
  std::vector<DimensionMotion> motion{};
  SolvedHow how{};
  Time depth_needed{};
  Time lead{};
  AdvisedLimits limits{};
  std::vector<Hiccup> hiccups{};  ///< 100 and 300 ms, with the lead and with kShortLead
};

/// Advice for a table as measure_motion takes it, which goes on after its end if `goes_on`. A
/// settle lag that is not given is chosen. Throws InputError if the rows are too few.
[[nodiscard]] Advice advise(const WaypointTable& table, Time freeze_ahead,
                            std::optional<std::size_t> settle, bool goes_on);

}  // namespace splinecast::apps
