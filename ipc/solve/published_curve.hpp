#pragma once

#include <cstddef>
#include <optional>

#include "core/motion/plan.hpp"
#include "core/motion/plan_search.hpp"
#include "core/online/sliding_window.hpp"
#include "ipc/board/reader.hpp"
#include "ipc/board/writer.hpp"
#include "ipc/layout/summary.hpp"
#include "ipc/runs/curve_cut.hpp"
#include "ipc/runs/outcomes.hpp"
#include "ipc/runs/slowed_end.hpp"
#include "ipc/solve/knot_writer.hpp"
#include "ipc/solve/plan_reader.hpp"
#include "ipc/solve/shown_motion.hpp"

namespace splinecast::ipc {

using core::EntryOptions;

/// What a curve that must keep its limits has done with a waypoint.
enum class Followed {
  taken,    ///< it has been appended
  waits,    ///< nothing: offer it again in the next step, after the commit
  refused,  ///< nothing: the curve cannot follow its waypoints
};

/// The end that is tried: slowing down, or an entry to the last waypoint from there.
enum class EndAttempt {
  slowing,       ///< slowing down from a knot of the published curve
  from_knots,    ///< at knots of the published curve, the latest one first
  from_settled,  ///< in the published curve, as it settles
  from_rest,     ///< where the published curve rests
};

/// A search for an end that has not ended.
struct EndSearch {
  EndAttempt attempt{};
  std::size_t knot = 0;  ///< from_knots: the knot after the one that is tried
};

/// The published curve of one stream: a plan, the knots of it on the board, and the searches for
/// what the plan does next. Has no ring and no clock; the caller checks the waypoints.
///
/// A solver that takes over, and one that has discarded a revision, continue from the last commit:
/// it remembers nothing else but the shown motion. Of a finished curve it then has only the rest
/// and the summary. Allocates only when constructed; one thread uses it.
class PublishedCurve {
 public:
  /// Maximum number of candidates that the searches of one step build and compare with the limits.
  /// In addition, a step may try each knot of the window before a cut or an end, and the fallback
  /// and the longest entries of a search.
  static constexpr int kTriesPerStep = 4;
  /// Knots that a stop may add.
  static constexpr std::size_t kAddedByStop = 2;

  /// `board` and `published` are the two sides of one board; both outlive the curve. Throws
  /// std::invalid_argument for window options out of range.
  PublishedCurve(KnotBoardWriter& board, const KnotBoardReader& published,
                 const core::WindowOptions& options, const DimensionKinds& kinds,
                 const EntryOptions& entries);

  /// Whether the board held data that this class did not write. The curve is unusable then.
  [[nodiscard]] bool is_damaged() const noexcept { return is_damaged_; }

  /// Continues from the last commit, whose summary is `summary`. O(K·D).
  void restore(const Summary& summary) noexcept;

  /// Prefetches the memory outside this object that the next append touches.
  void prefetch() const noexcept {
    window().prefetch();
    writer_.prefetch(plan_);
  }

  [[nodiscard]] const core::Plan& plan() const noexcept { return plan_; }
  [[nodiscard]] const core::SlidingWindow& window() const noexcept { return plan_.window(); }
  /// See Plan::nearest().
  [[nodiscard]] Waypoint nearest(const Waypoint& given) noexcept { return plan_.nearest(given); }

  [[nodiscard]] const DimensionKinds& kinds() const noexcept { return window().kinds(); }

  /// Whether there is anything to write since the last commit, and whether there is a curve.
  [[nodiscard]] bool has_changes() const noexcept { return writer_.has_changes(); }
  [[nodiscard]] bool has_begun() const noexcept { return writer_.newest() > 0 || has_changes(); }

  /// Whether the run is a stop from a state, and no waypoint has come since.
  [[nodiscard]] bool is_stop() const noexcept {
    return core::is<core::Waiting>(plan_.end()) && window().knots() == 0;
  }

  /// Whether the run begins after t and has met no waypoint.
  [[nodiscard]] bool begins_after(Time t) const noexcept {
    return core::is<core::Waiting>(plan_.end()) && plan_.unmet() == 0 && plan_.has_origin() &&
           t < plan_.origin().time;
  }

  /// Number of waypoints of the run that the committed curve meets after t.
  [[nodiscard]] Word waypoints_after(Time t) const noexcept;

  /// Whether the run is a stop that moves after t, and begins at `latest` or earlier.
  [[nodiscard]] bool is_stopping(Time t, Time latest) const noexcept {
    return is_stop() && plan_.has_origin() && writer_.origin().number > 1 &&
           !writer_.origin().is_corner && plan_.origin().time <= latest && t < end_of_motion();
  }

  /// A live stream's start is decided at the latest when settled_until reaches this time: `notice`
  /// before the start. max() if no decision is open.
  [[nodiscard]] Time start_decision() const noexcept {
    return plan_.is_start_open() ? window().time(0) - search_.options().notice : Time::max();
  }

  /// The time at which the curve comes to rest.
  [[nodiscard]] Time end_of_motion() const noexcept { return writer_.rest(); }

  /// Freezes the committed curve up to the right end of the segment that contains t. If this
  /// freezes the newest knot, the next waypoint needs an entry.
  void freeze(Time t) noexcept;

  /// Whether the board can take this many more knots without losing a segment that ends after
  /// `keep`. has_room_to_cut() answers this for the committed curve after a cut at t.
  [[nodiscard]] bool has_room(std::size_t knots, Time keep) const noexcept {
    return writer_.has_room(plan_, knots, keep);
  }
  [[nodiscard]] bool has_room_to_cut(Time t, std::size_t knots, Time keep) const noexcept;

  /// Begins the curve with a given state instead of a waypoint.
  void begin(const Instant& state) noexcept;

  /// The earliest time at which the committed curve can be cut: the left end of its oldest segment;
  /// min() if a hold precedes the curve, max() if there is no curve.
  [[nodiscard]] Time earliest_cut() const noexcept;

  /// Cuts the committed curve at t and begins a run there. Requires a segment at t, and no
  /// uncommitted changes. Changes nothing if the board is damaged.
  void begin_run(Time t, const RunBegin& how) noexcept;

  /// Where the curve with this waypoint exceeds a limit: see PlanSearch::excess_with(). O(1)
  /// without limits, else O(K·D). Does not change the curve.
  [[nodiscard]] std::optional<LimitExcess> excess_with(const Waypoint& waypoint,
                                                       Time settled) noexcept {
    return search_.has_limits() ? find_excess(waypoint, settled) : std::nullopt;
  }

  /// Where the stop in which the committed curve ends, or has been ended, exceeds a limit or passes
  /// a bound; nothing if it keeps them. Requires a curve that has begun.
  [[nodiscard]] std::optional<LimitExcess> stop_excess() noexcept;

  /// Appends a waypoint so that the curve keeps its limits (Beyond::enter). Where the spline with
  /// it exceeds one, which `excess` then says, the curve leaves the spline: by an entry from the
  /// newest knot that allows one, else at its newest knot. After kUnmetRefused without a waypoint
  /// met its plan stays; it then takes only one to which an entry from rest can lead.
  [[nodiscard]] Followed follow(const Waypoint& waypoint, Word item, Time settled, Time keep,
                                int& tries, std::optional<LimitExcess>& excess) noexcept;

  /// Appends a waypoint to the run; `item` is its number in the ring.
  void append(const Waypoint& waypoint, Word item) noexcept;

  /// Continues the search for an entry, if one is needed. The entry begins at `settled`, or where
  /// the open entry begins if that has not settled. Decrements `tries` for each candidate: see
  /// kTriesPerStep. `is_last`: no further waypoint can be taken in this step, so the search uses
  /// the known ones. Does not overwrite segments that end after `keep`.
  void advance_search(Time settled, Time keep, bool is_last, int& tries) noexcept {
    if (core::is_searching(plan_.end()) || window().options().held_before_start) {
      look_for_entry(settled, keep, is_last, tries);
    }
  }

  /// Whether a search for an entry is unfinished: a step has work to do without a new waypoint.
  [[nodiscard]] bool is_planning() const noexcept {
    return core::is_searching(plan_.end()) && !plan_.ended();
  }

  /// Whether the curve waits for newer waypoints to enter, although the next item is a replacement
  /// after all waypoints of the run, from time t on. Not on a live stream: it does not wait.
  [[nodiscard]] bool may_enter_before(Time t) const noexcept {
    return is_planning() && !is_live() && window().knots() > plan_.unmet() &&
           t >= plan_.newest_time();
  }

  /// Decides a start with limits that a cut at t keeps. Returns whether the curve has changes.
  [[nodiscard]] bool decide_start(Time t, Time settled, Time keep, int& tries) noexcept;

  /// Searches for an entry onto the waypoints that are known, and makes it part of the curve.
  /// Requires may_enter_before(). Otherwise a few waypoints between two stops would never be met.
  void enter_before_cut(Time settled, Time keep) noexcept;

  /// Ends the curve. Decides its start first, if that is open; a curve away from its target may
  /// enter onto it at an earlier waypoint first. Then the first of these that keeps the limits:
  ///
  /// 1. at the newest knot, with the boundary condition `end`: on a recorded stream always, on a
  ///    live one if the curve rests there;
  /// 2. by slowing down on the path, from the latest knot after `settled` that allows it: the curve
  ///    rests at the newest knot, later than that knot's time;
  /// 3. by an entry that begins at the latest knot after `settled` that allows it and rests at the
  ///    newest one, at its time or later;
  /// 4. in the shortest stop after the newest knot that keeps the limits of acceleration and jerk;
  ///    without a limit of acceleration, in the published one.
  ///
  /// If the segment before the newest knot has settled, or the published curve does not meet that
  /// knot: by an entry from `settled` on, or from the newest knot if that is later; else by one of
  /// at most EntrySearch::kLongest from where the published stop rests; else in that stop.
  ///
  /// Returns false if the search has not ended: then call finish() again in the next step, after
  /// the commit. Does not overwrite segments that end after `keep`.
  [[nodiscard]] bool finish(const Condition& end, Time settled, Time keep, int& tries) noexcept;

  /// How long after its newest waypoint's time a curve that does not end as requested rests at it.
  [[nodiscard]] Time end_lateness() const noexcept {
    const bool is_late = plan_.ending() == EndKind::slowed || plan_.ending() == EndKind::entered;
    return is_late ? plan_.ended()->rest - plan_.newest_time() : Time::zero();
  }

  /// Writes the changes to the board. Returns the earliest time at which the curve changes; max()
  /// if it does not change.
  [[nodiscard]] Time write() noexcept;

  /// Writes the curve's part of the summary, as of the last write.
  void write_summary(Summary& out) const noexcept { writer_.write_summary(plan_, out); }

  /// How far the curve has come with the waypoints of its run.
  [[nodiscard]] RunProgress progress() const noexcept;

  /// Call after the commit of this summary.
  void committed(const Summary& summary) noexcept;

 private:
  /// Whether the first piece of the stream begins at the plan's origin.
  [[nodiscard]] bool begins_stream() const noexcept {
    return plan_.has_origin() && writer_.origin().number == 1;
  }
  /// Whether the published curve ends with a piece of the target.
  [[nodiscard]] bool is_on_target() const noexcept { return plan_.is_on_target(); }

  // Room, and what precedes the plan: published_curve.cpp.
  [[nodiscard]] bool has_room_to_enter(Time keep) const noexcept;
  /// The state at a cut and the number of its knot; nothing if a piece begins in the old origin.
  struct NewOrigin {
    std::optional<Instant> state;
    std::optional<Word> number;
  };
  /// Writes the cut that was found, if the next piece begins there.
  [[nodiscard]] NewOrigin write_cut() noexcept;

  [[nodiscard]] bool is_live() const noexcept { return search_.options().is_live; }

  // Entries: entries.cpp.
  void check_start(Time settled, bool is_decision) noexcept;
  void look_at_shown() noexcept;
  void restore_shown() noexcept;
  [[nodiscard]] const MotionLimits* shown() const noexcept {
    return is_live() ? &shown_.limits() : nullptr;
  }
  [[nodiscard]] bool find_cut(Time t) noexcept;
  [[nodiscard]] bool find_state(Time settled) noexcept;
  [[nodiscard]] bool find_reach(Time until) noexcept;
  [[nodiscard]] bool prepare(Time settled) noexcept;
  /// The state at which an entry begins. Requires prepare().
  [[nodiscard]] Instant begin_state() const noexcept {
    return uses_cut_ ? cut_.state() : plan_.origin();
  }
  [[nodiscard]] core::EntryBegin entry_begin() const noexcept { return {begin_state(), shown()}; }
  void look_for_entry(Time settled, Time keep, bool is_last, int& tries) noexcept;
  void search_entry(Time settled, Time keep, bool is_last, int& tries) noexcept;
  void enter() noexcept;

  // Limits: excess.cpp.
  [[nodiscard]] std::optional<LimitExcess> find_excess(const Waypoint& waypoint,
                                                       Time settled) noexcept;
  [[nodiscard]] bool has_room_to_leave(Time settled, Time keep) const noexcept;
  [[nodiscard]] core::PlanSearch::Outcome search_from_knot(const Waypoint& waypoint,
                                                           int& tries) noexcept;
  [[nodiscard]] Followed leave(const Waypoint& waypoint, Word item, Time settled, Time keep,
                               int& tries) noexcept;
  void leave_at(std::size_t knot, const Waypoint& waypoint, Word item) noexcept;
  [[nodiscard]] Followed follow_from_rest(const Waypoint& waypoint, Word item, Time settled,
                                          Time keep, int& tries) noexcept;

  // The end: finish.cpp.
  /// Whether this end is being tried.
  [[nodiscard]] bool is_trying(EndAttempt attempt) const noexcept {
    return end_search_ && end_search_->attempt == attempt;
  }
  [[nodiscard]] bool slow_down(Time settled, int& tries) noexcept;
  [[nodiscard]] bool search_end_from_knots(Time settled, int& tries) noexcept;
  [[nodiscard]] bool prepare_end(Time settled) noexcept;
  [[nodiscard]] bool search_end(Time settled, int& tries) noexcept;

  const KnotBoardReader* published_;
  core::Plan plan_;
  KnotWriter writer_;
  PlanReader plan_reader_;
  core::PlanSearch search_;
  Summary summary_;  ///< last committed
  CurveCut cut_;
  SlowedEnd slowed_;
  ShownMotion shown_;
  bool is_prepared_ = false;  ///< this step has found the state from which an entry may begin
  bool uses_cut_ = false;     ///< that state is cut_.state(), else the origin
  std::optional<Word> leaving_item_{};  ///< for this waypoint the curve searches where to leave
  std::size_t leaving_knot_ = 0;        ///< from this knot of the target
  std::optional<EndSearch> end_search_;
  bool is_damaged_ = false;
  BoardSegment read_;      ///< scratch
  core::Segment segment_;  ///< scratch
};

}  // namespace splinecast::ipc
