#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "core/motion/end.hpp"
#include "core/motion/entry_search.hpp"
#include "core/online/sliding_window.hpp"
#include "core/polynomial/segment.hpp"
#include "splinecast/boundary_condition.hpp"
#include "splinecast/state.hpp"
#include "splinecast/time.hpp"
#include "splinecast/waypoint.hpp"

namespace splinecast::core {

/// What a plan continues from. Spans have D values.
struct PlanState {
  End end{};
  std::size_t met = 0;
  std::size_t unmet = 0;
  std::size_t knots = 0;   ///< of the run
  std::size_t frozen = 0;  ///< leading ones of them
  std::size_t passed_over = 0;
  bool is_later_run = false;
  std::optional<Instant> origin{};
  std::optional<Instant> entry_end{};  ///< of an end `Entering` only the acceleration counts
  Time blend_until = Time::min();
  Time unmet_since = Time::max();
  Time refused_until = Time::max();
};

/// The curve of a run as a value: the window of its knots, whose spline is the *target*, and how
/// the curve ends. Knows no board, no clock and no other process.
///
/// The curve equals the target, except where an *entry* leads onto the target: when the newest knot
/// has settled before its successor came, after a cut, and where a stream starts in motion. The
/// knots before its end are passed over. Until an entry is found the curve does not change, and
/// ends at rest. An entry that ends at a waypoint is final once it has begun; one that ends ahead
/// of the newest waypoint is planned again when a newer one comes.
///
/// Each operation imposes a decision: it refuses nothing because of limits and searches for nothing
/// (see PlanSearch). After each:
///
/// - the curve ends at rest: in the stop after the newest knot, in that of its origin or after its
///   entry, or where it has been ended; only a condition of end_on_target() may leave a velocity;
/// - nothing before the frozen time has changed, except by a cut;
/// - each waypoint of the run is met, passed over, or waits for an entry.
///
/// The *origin* is the state in which the open entry begins or, without one, in which the curve
/// stops or rests without having come from the target. Allocates only when constructed; one thread
/// uses it.
class Plan {
 public:
  /// `counts_unmet`: unmet_since() is kept. Throws as SlidingWindow does.
  Plan(std::size_t dimensions, const WindowOptions& options, bool counts_unmet = false);

  [[nodiscard]] const SlidingWindow& window() const noexcept { return window_; }
  [[nodiscard]] const End& end() const noexcept { return end_; }

  /// Whether the curve ends with a piece of the target. Its first knot is number met() of the run,
  /// which means nothing on a curve that is away from its target.
  [[nodiscard]] bool is_on_target() const noexcept { return core::is_on_target(end_); }
  [[nodiscard]] std::size_t met() const noexcept { return met_; }

  /// The first knot of the run that the curve had not met or passed over before its open entry, or,
  /// without one, before its end.
  [[nodiscard]] std::size_t unmet() const noexcept { return unmet_; }

  /// Number of waypoints that the curve passes over, in all runs, if no newer ones come: those that
  /// wait for an entry count, so the number can fall.
  [[nodiscard]] std::size_t passed_over() const noexcept {
    return passed_before_ + passed_by_entry();
  }

  [[nodiscard]] bool has_origin() const noexcept { return origin_.has_value(); }

  /// The origin, its acceleration within the limits. The spans are valid until it changes.
  [[nodiscard]] Instant origin() const noexcept;

  /// The state at the end of an entry. Of an entry that ends at a waypoint only the acceleration.
  [[nodiscard]] const State& entry_end() const noexcept { return entry_end_; }

  /// The length of the stop after an entry that ends ahead of the newest waypoint. The motion at
  /// the end of the former stop may need longer than the remainder of that.
  [[nodiscard]] Time stop_after_entry(const EnteringAhead& ahead) const noexcept;

  /// The state in which that stop begins: at the end of the straight line, whose position is
  /// written to `scratch`, D values, or without a line at the end of the entry.
  [[nodiscard]] Instant stop_begin(const EnteringAhead& ahead,
                                   std::span<double> scratch) const noexcept;

  /// How the curve has been ended; nothing if it continues.
  [[nodiscard]] const std::optional<Ended>& ended() const noexcept { return ended_; }
  [[nodiscard]] EndKind ending() const noexcept { return ended_ ? ended_->kind : EndKind::none; }

  /// The time of the newest knot of the run, or of the origin; {} without both.
  [[nodiscard]] Time newest_time() const noexcept;

  /// The position that the next waypoint is unwrapped to: that of the newest waypoint of the run,
  /// or of the state that the run was entered from; empty if there is neither.
  [[nodiscard]] std::span<const double> newest_position() const noexcept;

  /// A waypoint, moved to its representative nearest to newest_position(): see DimensionKinds. A
  /// view, valid until the next call. O(D).
  [[nodiscard]] Waypoint nearest(const Waypoint& given) noexcept;

  /// The time of the run's first knot that has not settled: no append changes the run before it.
  [[nodiscard]] Time settled_until() const noexcept;

  /// No entry of the run ends before this time.
  [[nodiscard]] Time blend_until() const noexcept { return blend_until_; }

  /// Since when the curve has met no waypoint, and until when it refuses those that it cannot
  /// follow; max(): not so.
  [[nodiscard]] Time unmet_since() const noexcept { return unmet_since_; }
  [[nodiscard]] Time refused_until() const noexcept { return refused_until_; }
  [[nodiscard]] bool has_given_up() const noexcept { return refused_until_ < Time::max(); }

  /// Whether the start of a first run, at rest at its first waypoint, can still be changed.
  [[nodiscard]] bool is_start_open() const noexcept;

  /// Whether the run is the first one, and starts at rest at its first waypoint.
  [[nodiscard]] bool starts_from_halt() const noexcept;

  /// Continues from a state, and from knots of the run's window: `knots` as SlidingWindow::restore.
  void restore(const PlanState& state, std::span<const Knot> knots) noexcept;

  /// Continues from another plan with the same options, which has not been ended on its target.
  /// `scratch`: window().knots_to_restore() knots. O(K·D).
  void copy_from(const Plan& other, std::span<Knot> scratch) noexcept;

  /// Begins a run in a state instead of at a waypoint.
  void begin(const Instant& state) noexcept;

  /// Cuts the curve, and begins a run in a state; no entry of it ends earlier than `blend` after
  /// that.
  void cut(const Instant& state, Time blend) noexcept;

  /// Appends a waypoint. Returns whether a search for an entry begins: on a curve that is away from
  /// its target. O(K·D).
  bool append(const Waypoint& waypoint) noexcept;

  enum class Frozen {
    nothing_to_do,
    left_target,     ///< the newest knot is frozen: only an entry leads to the next one
    searches_again,  ///< an entry that was not found may now be found, because it begins later
  };
  /// Freezes the curve up to the right end of the segment that contains t.
  Frozen freeze(Time t) noexcept;
  /// Freezes the leading `count` knots of the target, as recorded. The end stays as it is.
  void freeze_knots(std::size_t count) noexcept { window_.freeze_knots(count); }

  /// Lets the curve rest at the first waypoint. Requires is_start_open(), as do the next two.
  void rest_at_start() noexcept;
  /// After that: lets the curve follow the target from the first waypoint on.
  void start_on_target() noexcept;
  /// After that: lets the curve start by an entry, which is searched for.
  void start_by_entry() noexcept;

  /// Ends the curve's way on the target at a knot, which it meets. Then only an entry returns to
  /// it.
  void leave_target_at(std::size_t knot) noexcept;

  /// Makes an entry part of the curve: from a state of the published curve or, without one, from
  /// the origin.
  void enter(const EntryEnd& end, const std::optional<Instant>& from) noexcept;

  /// Begins or ends the search for an entry.
  void set_searching(bool is_searching) noexcept { core::set_searching(end_, is_searching); }

  /// Records until when waypoints are refused because the curve cannot follow them.
  void give_up_until(Time t) noexcept { refused_until_ = t; }
  /// Records that the curve has taken a waypoint again, at t.
  void resume_at(Time t) noexcept;

  /// Ends the curve on the target with a boundary condition. Requires is_on_target().
  void end_on_target(const Condition& end) noexcept;
  /// Ends the curve in a stop, or slowed down on its path.
  void end_as(const Ended& how) noexcept { ended_ = how; }
  /// Ends a curve that rests at its newest knot already.
  void end_at_newest() noexcept;
  /// Ends the curve by an entry that rests at its newest knot: as enter().
  void end_by_entry(Time rest, const std::optional<Instant>& from) noexcept;
  /// The same, from the state at the knot before `knot` of the target's last piece.
  void end_by_entry_from_target(Time rest, const Instant& from, std::size_t knot) noexcept;

 private:
  void set_origin(const Instant& state) noexcept;
  void wait_for_entry(std::size_t unmet) noexcept;
  void restart_unmet_since() noexcept;
  bool meets_known(Time t) noexcept;
  void mark_newest_met() noexcept;
  [[nodiscard]] std::size_t passed_by_entry() const noexcept;

  SlidingWindow window_;
  bool counts_unmet_;
  End end_;
  std::optional<Ended> ended_;
  std::optional<Time> origin_;
  State origin_state_;
  State entry_end_;
  std::size_t met_ = 0;
  std::size_t unmet_ = 0;
  std::size_t passed_before_ = 0;  ///< by entries that have ended
  Time blend_until_ = Time::min();
  Time unmet_since_ = Time::max();
  Time refused_until_ = Time::max();
  std::vector<double> moved_;  ///< of nearest(): position, velocity, acceleration
};

}  // namespace splinecast::core
