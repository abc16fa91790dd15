#pragma once

#include <array>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "ipc/layout/summary.hpp"
#include "tests/campaign/ends/plan.hpp"

namespace splinecast::campaign::ends {

/// A rule of the published curve and its end.
enum class Rule : std::uint8_t {
  ends_at_rest,
  requested_end_rests,
  settled,
  continuous,
  stop_limits,
  stop_slows,
  stop_bounds,
  rotation_stops,
  endless_stops,
  entered_stop_limits,
  entry_limits,
  entry_begins,
  entry_bounds,
  cut_bounds,
  entry_shown,
  end_limits,
  end_bounds,
  end_shown,
  end_within_path,
  excess_counted,
  past_not_compared,
  law_rate,
  comes_to_rest,
  slow_entry,
  accounts,
  waypoints_accounted,
  passed_exactly,
  rest_at_begin,
  end_kind,
  samples,
  finishes,
  near_path,
};
inline constexpr std::size_t kRules = 32;

/// Events that a long campaign has to provoke, in addition to those of LifePlan.
enum class Event : std::uint8_t {
  revisions,
  takeovers,
  takeovers_in_search,
  torn_takeovers,
  entries,
  stops,
  stops_past_bounds,
  excesses,
  refusals,
  searches_postponed,
  ends_from_rest,
  ends_at_once,
  ends_outside_bounds,
  held_ends,
  starvations,
  waypoints,
  waypoints_passed_over,
  withdrawals,
};
inline constexpr std::size_t kEvents = 18;

/// Counters of all lives of one thread.
class Tally {
 public:
  void begin_life(const LifePlan& plan);
  /// Counts a violation and writes it, with the seed, to standard error.
  void breach(Rule rule, const std::string& what);
  void count(Event event, std::uint64_t times = 1) noexcept {
    events_[static_cast<std::size_t>(event)] += times;
  }
  /// Counts the end of the curve of a finished life.
  void count_end(ipc::EndKind kind, Time late);
  void add_path_error(double error) { errors_.push_back(error); }
  void add(const Tally& other);

  [[nodiscard]] bool life_failed() const noexcept { return life_failed_; }
  [[nodiscard]] std::uint64_t lives() const noexcept { return lives_; }
  [[nodiscard]] nlohmann::json found() const;
  [[nodiscard]] nlohmann::json measured() const;
  [[nodiscard]] std::vector<std::string> not_covered() const;

 private:
  [[nodiscard]] std::vector<std::pair<std::string, std::uint64_t>> required() const;

  std::uint64_t seed_ = 0;
  std::string description_;
  bool life_failed_ = false;
  std::uint64_t lives_ = 0;
  std::array<std::uint64_t, kRules> breaches_{};
  std::array<std::uint64_t, kEvents> events_{};
  std::array<std::uint64_t, kEndings> endings_{};
  std::array<std::uint64_t, kWhens> whens_{};
  std::array<std::uint64_t, kWalls> walls_{};
  std::array<std::uint64_t, kLimitClasses> limits_{};
  std::array<std::uint64_t, ipc::kEndKinds> ends_{};
  std::array<std::uint64_t, 8> conditions_{};
  std::vector<std::uint64_t> methods_ = std::vector<std::uint64_t>(32);
  std::array<std::uint64_t, kDimensionKinds> kinds_{};
  std::uint64_t laws_ = 0;
  std::vector<double> errors_;    ///< relative path errors of slowed ends
  std::vector<double> lateness_;  ///< s, of slowed ends
};

}  // namespace splinecast::campaign::ends
