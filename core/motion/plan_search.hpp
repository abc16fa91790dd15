#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "core/limits/position_range.hpp"
#include "core/motion/entry_search.hpp"
#include "core/motion/plan.hpp"
#include "core/motion/trial.hpp"
#include "core/polynomial/segment.hpp"
#include "splinecast/boundary_condition.hpp"
#include "splinecast/limits.hpp"
#include "splinecast/state.hpp"
#include "splinecast/time.hpp"
#include "splinecast/waypoint.hpp"

namespace splinecast::core {

/// How a published curve returns to its target.
struct EntryOptions {
  bool is_live = false;       ///< false: an entry waits until K newer waypoints are known
  Time least_entry{};         ///< length of the shortest entry
  Time notice{};              ///< a live stream's start is decided this long before it settles
  bool keeps_limits = false;  ///< Beyond::enter: the curve leaves its target where that exceeds one
  bool checks_stops = false;  ///< the stop after a waypoint counts, too: not Beyond::report
};

/// Where an entry begins, and the limits that the motion has shown; null: none.
struct EntryBegin {
  Instant state{};
  const MotionLimits* shown = nullptr;
};

/// Searches for what a plan can do next, and compares it with the limits before it is decided.
/// Never changes a plan. What precedes the plan's window is given: the state in which an entry
/// begins, and the range of the curve after it.
///
/// A search that finds nothing returns nothing. Allocates only when constructed; one thread uses
/// it.
class PlanSearch {
 public:
  using Outcome = EntrySearch::Outcome;

  /// `window`: the options of the plans. Throws as SlidingWindow does.
  PlanSearch(std::size_t dimensions, const WindowOptions& window, const EntryOptions& options);

  [[nodiscard]] const EntryOptions& options() const noexcept { return options_; }
  [[nodiscard]] bool has_limits() const noexcept { return has_limits_; }

  /// The positions that the plan's curve reaches anyway after the begin of an entry. Set it before
  /// each search from another state.
  [[nodiscard]] PositionRange& reach() noexcept { return reach_; }
  [[nodiscard]] const PositionRange& reach() const noexcept { return reach_; }

  /// Forgets which candidates have failed: of the entry that a plan needs, of one to knot `first`
  /// or later, or of one that ends a plan.
  void restart(const Plan& plan) noexcept;
  void restart_at(std::size_t first) noexcept { search_.restart(first); }

  /// Searches for the entry that a plan needs. `is_last`: no further waypoint can be appended in
  /// this step, so the search uses the known ones. Tries at most `tries` candidates, which it
  /// counts down.
  [[nodiscard]] Outcome search(const Plan& plan, const EntryBegin& from, bool is_last,
                               int& tries) noexcept;

  /// Searches for an entry that ends at a waypoint before the last one: for the end of a run, when
  /// no newer waypoints come. Returns whether there is one. O(knots in the window) candidates.
  [[nodiscard]] bool search_before_end(const Plan& plan, const EntryBegin& from) noexcept;

  /// Searches for an entry onto a plan with a waypoint more, of which the leading `frozen` knots do
  /// not change.
  [[nodiscard]] Outcome search_with(const Plan& plan, const Waypoint& waypoint, std::size_t frozen,
                                    const EntryBegin& from, int& tries) noexcept;

  /// Searches for an entry of at most `longest` that rests at a plan's newest waypoint.
  [[nodiscard]] Outcome search_rest(const Plan& plan, const EntryBegin& from, Time longest,
                                    int& tries) noexcept;

  /// The longest entry that may end a plan whose curve comes to rest at `rest`: as long as that
  /// curve and, after it, an entry from rest: kLongest, or what the given limits require from where
  /// that curve is farthest away. The components of a quaternion count as positions.
  [[nodiscard]] Time longest_end(const Plan& plan, Time from, Time rest) const noexcept;

  /// Whether a curve rests at a plan's newest waypoint from `from` on, and never leaves it.
  [[nodiscard]] bool rests_at_newest(const Plan& plan, const Instant& from) const noexcept;

  /// The end and the polynomial of the entry that was found last.
  [[nodiscard]] const EntryEnd& end() const noexcept { return search_.end(); }
  [[nodiscard]] const Segment& entry() const noexcept { return search_.entry(); }

  /// Whether a plan that starts on its target keeps the limits. Requires plan.is_start_open().
  [[nodiscard]] bool keeps_start(const Plan& plan, const MotionLimits* shown) noexcept;

  /// Whether the first segments of a plan will be compared later: see keeps_start().
  [[nodiscard]] bool awaits_start_check(const Plan& plan) const noexcept;

  /// The largest excess of a segment that exceeds a limit with this waypoint; unless the options
  /// keep the limits, one that exceeds it without the waypoint, too, does not count. Without such a
  /// segment that of the stop after the waypoint, if the options check stops; else nothing.
  /// Compares only what a curve that is settled until `settled` may still follow. `begins_stream`:
  /// the plan's origin is the beginning of its stream. O(1) without limits, else O(K·D).
  [[nodiscard]] std::optional<TimedExcess> excess_with(const Plan& plan, const Waypoint& waypoint,
                                                       Time settled, bool begins_stream) noexcept {
    if (!has_limits_ || plan.window().knots() == 0) return std::nullopt;
    return find_excess(plan, waypoint, settled, begins_stream);
  }

  /// Where a stop exceeds a limit of acceleration or jerk, or passes a bound.
  [[nodiscard]] std::optional<TimedExcess> excess_of_stop(const Segment& stop) noexcept {
    return trial_.excess_of_stop(stop);
  }

  /// Whether a plan that ends on its target with a condition rests at its newest knot and keeps the
  /// limits: a segment that exceeds one must not exceed it more than without the end. A recorded
  /// stream ends as requested.
  [[nodiscard]] bool keeps_limits_with(const Plan& plan, const Condition& end, Time settled,
                                       const MotionLimits& shown) noexcept;

  /// The limits of an end, as of the last keeps_limits_with(), at each rate of a law: a dimension
  /// without a limit of acceleration has the one that the motion has shown.
  [[nodiscard]] const MotionLimits& end_limits() const noexcept { return end_limits_; }

  /// Writes the stop after the newest waypoint in which a plan can be ended: the shortest that
  /// keeps the limits of acceleration and jerk at each rate of a law, if any dimension has a limit
  /// of acceleration. Call keeps_limits_with() first.
  void build_stop_at_end(const Plan& plan, Segment& out) noexcept;

 private:
  [[nodiscard]] EntryRules rules(const Plan& plan, const EntryBegin& from) const noexcept;
  [[nodiscard]] std::size_t first_open(const Plan& plan, Time settled) const noexcept;
  [[nodiscard]] std::size_t first_compared(const Plan& plan, Time settled,
                                           bool begins_stream) const noexcept;
  [[nodiscard]] std::optional<TimedExcess> find_excess(const Plan& plan, const Waypoint& waypoint,
                                                       Time settled, bool begins_stream) noexcept;

  EntryOptions options_;
  bool has_limits_;
  EntrySearch search_;
  Trial trial_;
  PositionRange reach_;
  MotionLimits end_limits_;
  std::vector<double> values_;  ///< scratch
};

}  // namespace splinecast::core
