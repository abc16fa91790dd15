#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "splinecast/status.hpp"
#include "tests/campaign/streams/plan.hpp"

namespace splinecast::campaign {

/// A promise that a simulated stream can break.
enum class Breach : std::uint8_t {
  settled_changed,   ///< a settled sample changed later
  position_step,     ///< a step of the position between two settled segments
  velocity_step,     ///< a step of the velocity between two settled segments
  not_finite,        ///< a sample with NaN or infinite values
  not_at_rest,       ///< the newest segment does not end at rest
  no_answer,         ///< a sample at now without values although no writer overtook the reader
  items_lost,        ///< consumed ≠ interpolated + passed over + refused + withdrawn + controls
  waypoint_missed,   ///< the curve misses a waypoint that is not counted as passed over
  settled_back,      ///< settled_until decreased, or a step settled less than freeze-ahead
  unsettled_at_now,  ///< a sample at now that has not settled although the solver was in time
  false_revised,     ///< `revised` although no sampled value has changed
  change_not_reported,  ///< a sampled value has changed without `revised`
  miscounted,           ///< wrong count of late_commits or deadline_misses
  stop_late,            ///< a stop did not take effect in the step after it
  unbounded_step,       ///< more clock readings or items than a step may take
  board_refused,        ///< a solver found damage on a board that only solvers had written
  ring_torn,            ///< an item of the ring differs from the one that was sent
  not_verified,         ///< a repeated solve gives a curve with other bits
  beyond_limits,        ///< an entry or a stop exceeds both a limit and its own initial value
  stop_turned,          ///< a stop speeds up, reverses or moves further than |v|·T/2
};
inline constexpr std::size_t kBreaches = 20;
[[nodiscard]] std::string_view to_string(Breach breach) noexcept;

/// Events of simulated streams. Each must occur in a campaign.
enum class Event : std::uint8_t {
  streams,
  revisions,
  starvations,
  entries,
  extrapolated_ends,
  entries_replaced,
  stop_segments,
  replacements,
  blends,
  excesses,
  cuts,
  stops,
  withdrawals,
  deadline_misses,
  late_commits,
  takeovers,
  torn_takeovers,
  producer_continuations,
  torn_appends,
  starts_in_motion,
  finishes,
  returns_after_finish,
  solver_hold_ups,
  settled_raises,
  waypoints_interpolated,
  waypoints_passed_over,
  knots_compared,
  settled_samples_read_again,
  items_observed,
  segments_verified,
};
inline constexpr std::size_t kEvents = 30;
[[nodiscard]] std::string_view to_string(Event event) noexcept;

/// Counters of events and breaches over all simulated streams.
class StreamFindings {
 public:
  /// Begins the findings of the next stream.
  void begin_stream(const StreamPlan& plan);
  [[nodiscard]] std::uint64_t seed() const noexcept { return seed_; }

  void count(Event event, std::uint64_t times = 1) noexcept {
    events_[static_cast<std::size_t>(event)] += times;
  }
  void count(SampleStatus status) noexcept { ++statuses_[static_cast<std::size_t>(status)]; }
  void count(AppendStatus status) noexcept { ++answers_[static_cast<std::size_t>(status)]; }
  void count(Refusal refusal) noexcept { ++refusals_[static_cast<std::size_t>(refusal)]; }
  void count_simulated(Time time) noexcept { simulated_ += to_seconds(time); }

  /// Counts a breach, reports it with the seed to standard error, and marks the stream as failed.
  void breach(Breach breach, const std::string& what);
  [[nodiscard]] bool stream_failed() const noexcept { return stream_failed_; }

  /// Simulated time in s.
  [[nodiscard]] double simulated() const noexcept { return simulated_; }
  [[nodiscard]] std::uint64_t streams() const noexcept {
    return events_[static_cast<std::size_t>(Event::streams)];
  }

  /// Breaches by name.
  [[nodiscard]] nlohmann::json found() const;
  /// All other counters by name.
  [[nodiscard]] nlohmann::json coverage() const;
  /// Names of the required counters that are 0.
  [[nodiscard]] std::vector<std::string> not_covered() const;

 private:
  [[nodiscard]] std::map<std::string, std::uint64_t> required() const;

  std::uint64_t seed_ = 0;
  std::string description_;  ///< of the stream, for messages
  bool stream_failed_ = false;
  double simulated_ = 0;
  std::array<std::uint64_t, kBreaches> breaches_{};
  std::array<std::uint64_t, kEvents> events_{};
  std::array<std::uint64_t, kSampleStatuses> statuses_{};
  std::array<std::uint64_t, kAppendStatuses> answers_{};
  std::array<std::uint64_t, 64> refusals_{};
  std::array<std::uint64_t, kDimensionKinds> kinds_{};
  std::array<std::uint64_t, kLimitClasses> limits_{};
  std::map<std::string, std::uint64_t> methods_;
};

}  // namespace splinecast::campaign
