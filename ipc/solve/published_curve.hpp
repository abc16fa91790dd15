#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "core/motion/end.hpp"
#include "core/motion/entry_search.hpp"
#include "core/motion/trial.hpp"
#include "core/online/sliding_window.hpp"
#include "ipc/board/knot.hpp"
#include "ipc/board/reader.hpp"
#include "ipc/board/writer.hpp"
#include "ipc/layout/summary.hpp"
#include "ipc/runs/slowed_end.hpp"
#include "ipc/solve/curve_cut.hpp"
#include "ipc/solve/curve_summary.hpp"
#include "ipc/solve/shown_motion.hpp"

namespace splinecast::ipc {

/// The curve of one stream: the window that is being solved, which is the *target*, and the board
/// on which knots are published. Has no ring and no clock; the caller checks the waypoints.
///
/// The published curve equals the target, except where an *entry* leads onto the target: when the
/// newest knot has settled before its successor came, after a cut, and where a stream starts in
/// motion. Waypoints before its end are knots of the target that the curve passes over; they have
/// their own slots on the board, for a solver that takes over. Until an entry is found the curve
/// does not change, and ends at rest. An entry that ends at a waypoint is final once it has begun;
/// one that ends beyond the newest waypoint is planned again when a newer one comes.
///
/// Knots on the board have consecutive numbers, run after run: `Summary::run` is the first knot of
/// a run, which is its first waypoint or the state that it was entered from. A solver that takes
/// over, and one that has discarded a revision, continue from the last commit: nothing else is
/// remembered. Allocates only when constructed; one thread uses it.
class PublishedCurve {
 public:
  /// Maximum number of candidates that one step builds and compares with the limits: bounds the
  /// duration of a step.
  static constexpr int kTriesPerStep = 4;
  /// Knots that a stop may add.
  static constexpr std::size_t kAddedByStop = 2;

  /// `board` and `published` are the two sides of one board; both outlive the curve. Throws
  /// std::invalid_argument for window options out of range.
  PublishedCurve(KnotBoardWriter& board, const KnotBoardReader& published,
                 const core::WindowOptions& options, DimensionKinds kinds,
                 const EntryOptions& entries);

  /// Whether the board held data that this class did not write. The curve is unusable then.
  [[nodiscard]] bool is_damaged() const noexcept { return is_damaged_; }

  /// Continues from the last commit, whose summary is `summary`. O(K·D).
  void restore(const Summary& summary) noexcept;

  /// Prefetches the memory outside this object that the next append touches.
  void prefetch() const noexcept;

  [[nodiscard]] const core::SlidingWindow& window() const noexcept { return window_; }
  [[nodiscard]] const DimensionKinds& kinds() const noexcept { return kinds_; }
  [[nodiscard]] Course course() const noexcept { return course_of(end_); }

  /// The position that the next waypoint is unwrapped to: that of the newest waypoint of the run,
  /// or of the state that the run was entered from; empty if there is neither.
  [[nodiscard]] std::span<const double> newest_position() const noexcept;

  /// Whether anything has been changed since the last commit, and whether there is a curve.
  [[nodiscard]] bool has_changes() const noexcept { return has_changes_; }
  [[nodiscard]] bool has_begun() const noexcept { return newest_ > 0 || has_changes_; }

  /// The time of the newest knot of the run, or of the state that the run was entered from: the
  /// next waypoint must be after it. Requires a run.
  [[nodiscard]] Time newest_time() const noexcept;

  /// The time of the run's first knot that has not settled: no append changes the run before it.
  [[nodiscard]] Time settled_until() const noexcept;

  /// Whether the run is a stop from a state, and no waypoint has come since.
  [[nodiscard]] bool is_stop() const noexcept {
    return core::is<core::Waiting>(end_) && window_.knots() == 0;
  }

  /// Whether the run begins after t and has met no waypoint.
  [[nodiscard]] bool begins_after(Time t) const noexcept {
    return core::is<core::Waiting>(end_) && unmet_ == 0 && origin_.number > 0 && t < origin_.time;
  }

  /// Number of waypoints of the run that the committed curve is on after t.
  [[nodiscard]] Word waypoints_after(Time t) const noexcept;

  /// Whether the run is a stop that moves after t, and begins at `latest` or earlier.
  [[nodiscard]] bool is_stopping(Time t, Time latest) const noexcept {
    return is_stop() && origin_.number > 1 && !origin_.is_corner && origin_.time <= latest &&
           t < rest_;
  }

  /// A live stream's start is decided at the latest when settled_until reaches this time: `notice`
  /// before the start. max() if no decision is open.
  [[nodiscard]] Time start_decision() const noexcept {
    return is_start_open() ? window_.time(0) - entries_.notice : Time::max();
  }

  /// The time at which the curve comes to rest.
  [[nodiscard]] Time end_of_motion() const noexcept { return rest_; }

  /// Freezes the committed curve up to the right end of the segment that contains t. If this
  /// freezes the newest knot, the next waypoint needs an entry.
  void freeze(Time t) noexcept;

  /// Whether the board can take this many more knots without losing a segment that ends after
  /// `keep`. has_room_to_cut() answers this for the committed curve after a cut at t.
  [[nodiscard]] bool has_room(std::size_t knots, Time keep) const noexcept;
  [[nodiscard]] bool has_room_to_cut(Time t, std::size_t knots, Time keep) const noexcept;

  /// Begins the curve with a given state instead of a waypoint.
  void begin(const Instant& state) noexcept;

  /// The earliest time at which the committed curve can be cut: the left end of its oldest segment;
  /// min() if a hold precedes the curve, max() if there is no curve.
  [[nodiscard]] Time earliest_cut() const noexcept;

  /// Cuts the committed curve at t and begins a run there. Requires a segment at t, and no
  /// uncommitted changes. Changes nothing if the board is damaged.
  void begin_run(Time t, const RunBegin& how) noexcept;

  /// Finds the largest excess of a segment that exceeds a limit with this waypoint, but not without
  /// it; nothing if there is no such segment. Compares only the segments that the waypoint changes
  /// and that a curve that is settled until `settled` may still follow. O(1) without limits, else
  /// O(K·D). Does not change the curve.
  [[nodiscard]] std::optional<LimitExcess> excess_with(const Waypoint& waypoint,
                                                       Time settled) noexcept {
    return has_limits_ && window_.knots() > 0 ? find_excess(waypoint, settled) : std::nullopt;
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

  /// The state in which the run begins. Requires that it was entered from a state, and has no entry
  /// that has ended.
  [[nodiscard]] Instant origin_state() const noexcept;

  /// Appends a waypoint to the run; `item` is its number in the ring.
  void append(const Waypoint& waypoint, Word item) noexcept;

  /// Searches for an entry if one is needed. The entry begins at `settled`, or where the open entry
  /// begins if that has not settled. Decrements `tries` for each candidate: see kTriesPerStep.
  /// `is_last`: no further waypoint can be taken in this step, so the search uses the known ones.
  /// Does not overwrite segments that end after `keep`.
  void plan(Time settled, Time keep, bool is_last, int& tries) noexcept {
    if (core::is_searching(end_) || window_.options().held_before_start) {
      look_for_entry(settled, keep, is_last, tries);
    }
  }

  /// Whether a search for an entry is unfinished: a step has work to do without a new waypoint.
  [[nodiscard]] bool is_planning() const noexcept {
    return core::is_searching(end_) && ending() == EndKind::none;
  }

  /// Whether the curve waits for newer waypoints to enter, although the next item is a replacement
  /// after all waypoints of the run, from time t on. Not on a live stream: it does not wait.
  [[nodiscard]] bool may_enter_before(Time t) const noexcept {
    return is_planning() && !entries_.is_live && window_.knots() > unmet_ && t >= newest_time();
  }

  /// Decides a start with limits that a cut at t keeps. Returns whether the curve has changes.
  [[nodiscard]] bool decide_start(Time t, Time settled, Time keep, int& tries) noexcept;

  /// Searches for an entry onto the waypoints that are known, and makes it part of the curve.
  /// Requires may_enter_before(). So also a few waypoints between two stops are met.
  void enter_before_cut(Time settled, Time keep) noexcept;

  /// Ends the curve. The first of these that keeps the limits:
  ///
  /// 1. at the newest knot, with the boundary condition `end`; on a recorded stream always;
  /// 2. by slowing down on the path, from the latest knot after `settled` that allows it: the curve
  ///    rests at the newest knot, later than that knot's time;
  /// 3. by an entry that begins at the latest knot after `settled` that allows it and rests at the
  ///    newest one, at its time or later;
  /// 4. in the stop after the newest knot, as it is published.
  ///
  /// If the segment before the newest knot has settled, or the published curve does not meet that
  /// knot: by an entry from `settled` on; else by one of at most EntrySearch::kLongest from where
  /// the published stop rests; else in that stop.
  ///
  /// Returns false if the search has not ended: then call finish() again in the next step, after
  /// the commit. Does not overwrite segments that end after `keep`.
  [[nodiscard]] bool finish(const Condition& end, Time settled, Time keep, int& tries) noexcept;

  /// How the curve ends; EndKind::none before finish() has returned true.
  [[nodiscard]] EndKind ending() const noexcept {
    const auto* const ended = std::get_if<Ended>(&finish_);
    return ended != nullptr ? ended->kind : EndKind::none;
  }

  /// How long after its newest waypoint's time a curve that does not end as requested rests at it.
  [[nodiscard]] Time end_lateness() const noexcept {
    if (ending() == EndKind::slowed) return slowed_.end() - newest_time();
    return ending() == EndKind::entered ? std::get<Ended>(finish_).rest - newest_time()
                                        : Time::zero();
  }

  /// Writes the changes to the board. Returns the earliest time at which the curve changes; max()
  /// if it does not change.
  [[nodiscard]] Time write() noexcept;

  /// The curve's part of the summary, as of the last write.
  [[nodiscard]] CurveSummary summary() const noexcept;

  /// Call after the commit of this summary.
  void committed(const Summary& summary) noexcept;

 private:
  /// Number of knot i ≥ met_ of the run.
  [[nodiscard]] Word number_of(std::size_t knot) const noexcept {
    return met_number_ + knot - met_;
  }
  /// Whether the published curve ends with a piece of the target.
  [[nodiscard]] bool is_on_line() const noexcept { return core::is_on_target(end_); }

  // Room, origins and changes: published_curve.cpp.
  [[nodiscard]] bool has_room_behind(Word number, std::size_t knots, Time keep) const noexcept;
  [[nodiscard]] bool has_room_to_enter(Time keep) const noexcept;
  void set_origin(Word number, const Instant& state) noexcept;
  void wait_for_entry(std::size_t met) noexcept;
  void note_met() noexcept;
  void note_change(Time from) noexcept;
  void keep_settled() noexcept;
  [[nodiscard]] std::size_t passed_over() const noexcept;

  // Entries: entries.cpp.
  [[nodiscard]] bool starts_from_halt() const noexcept;
  [[nodiscard]] bool is_start_open() const noexcept;
  void rest_at_start() noexcept;
  void start_on_target() noexcept;
  void check_start(Time settled, bool is_decision) noexcept;
  void restart_search() noexcept;
  void look_at_shown() noexcept;
  void restore_shown() noexcept;
  [[nodiscard]] bool find_state(Time settled) noexcept;
  [[nodiscard]] bool find_reach(Time until) noexcept;
  [[nodiscard]] bool prepare(Time settled) noexcept;
  /// The state at which an entry begins. Requires prepare().
  [[nodiscard]] Instant begin_state() const noexcept {
    return uses_cut_ ? cut_.state() : origin_state();
  }
  [[nodiscard]] core::EntryRules entry_rules() const noexcept;
  void look_for_entry(Time settled, Time keep, bool is_last, int& tries) noexcept;
  void search_entry(Time settled, Time keep, bool is_last, int& tries) noexcept;
  void enter() noexcept;
  void enter_before_end() noexcept;

  // Limits: excess.cpp.
  [[nodiscard]] std::size_t first_open(Time settled) const noexcept;
  [[nodiscard]] std::size_t first_compared(Time settled) const noexcept;
  [[nodiscard]] std::optional<LimitExcess> find_excess(const Waypoint& waypoint,
                                                       Time settled) noexcept;
  void stop_behind_newest(core::Segment& out) noexcept;
  [[nodiscard]] bool has_given_up() const noexcept { return refused_until_ < Time::max(); }
  [[nodiscard]] bool awaits_start_check() const noexcept;
  [[nodiscard]] bool has_room_to_leave(Time settled, Time keep) const noexcept;
  [[nodiscard]] core::EntrySearch::Outcome search_from_knot(const Waypoint& waypoint,
                                                            int& tries) noexcept;
  [[nodiscard]] Followed leave(const Waypoint& waypoint, Word item, Time settled, Time keep,
                               int& tries) noexcept;
  void leave_at(std::size_t knot, const Waypoint& waypoint, Word item) noexcept;
  [[nodiscard]] Followed follow_from_rest(const Waypoint& waypoint, Word item, Time settled,
                                          Time keep, int& tries) noexcept;

  // Knots written to the board: write.cpp.
  void write_origin() noexcept;
  void write_beyond(const core::EnteringAhead& ahead) noexcept;
  void write_ending() noexcept;
  void write_passed(std::size_t first, std::size_t end) noexcept;
  void write_unmet(std::size_t end) noexcept;
  [[nodiscard]] std::size_t plain_knots() const noexcept;
  void write_knots(std::size_t first, std::size_t end) noexcept;
  void write_knot(std::size_t i) noexcept;
  void give_row(std::size_t i, const core::Knot& knot, KnotRecord& record) const noexcept;
  void write_off_line(bool writes_origin) noexcept;
  void write_on_line() noexcept;
  void drop_oldest() noexcept;

  // The end: finish.cpp.
  /// Whether this end is being tried.
  [[nodiscard]] bool is_trying(EndAttempt attempt) const noexcept {
    const auto* const search = std::get_if<SearchingEnd>(&finish_);
    return search != nullptr && search->attempt == attempt;
  }
  void finish_on_line(const Condition& end) noexcept;
  void find_end_limits() noexcept;
  [[nodiscard]] bool keeps_limits_with(const Condition& end, Time settled) noexcept;
  [[nodiscard]] bool slow_down(Time settled, int& tries) noexcept;
  [[nodiscard]] Instant rest_at_newest() noexcept;
  [[nodiscard]] bool search_end_from_knots(Time settled, int& tries) noexcept;
  void end_at_newest() noexcept;
  [[nodiscard]] bool prepare_end(Time settled) noexcept;
  [[nodiscard]] Time longest_end(const Instant& rest, Time from) const noexcept;
  [[nodiscard]] bool search_end(Time settled, int& tries) noexcept;
  void enter_end(const Instant& from) noexcept;

  // Resuming from the board: restore.cpp.
  void restore_course() noexcept;
  void restore_run() noexcept;
  void restore_origin() noexcept;
  [[nodiscard]] bool restore_beyond(Word& number) noexcept;
  [[nodiscard]] bool read_knot(Word number) noexcept;
  [[nodiscard]] bool find_knot(std::size_t i, Word& line) noexcept;
  [[nodiscard]] core::Knot restore_knot(std::span<double> values) noexcept;

  /// Number of knots before the passed-over ones that a window needs to continue: as many as a row
  /// and a slope depend on.
  static constexpr std::size_t kMetKept = core::kMaxReach + 3;

  /// Values of a knot that a window is restored from: waypoint, g, position, velocity, acceleration
  /// and residual of D each.
  static constexpr std::size_t kKnotValues = 6;

  KnotBoardWriter* board_;
  const KnotBoardReader* published_;
  DimensionKinds kinds_;
  core::SlidingWindow window_;
  core::Trial trial_;
  EntryOptions entries_;
  std::size_t look_ahead_;  ///< how many rows before the newest knot an append may change
  bool has_plain_knots_;    ///< an append changes only the velocities of older knots
  bool has_limits_;
  Summary summary_;  ///< last committed
  CurveCut cut_;
  core::EntrySearch search_;
  SlowedEnd slowed_;
  MotionLimits end_limits_;    ///< of an end: the given ones, else the acceleration that was shown
  core::PositionRange reach_;  ///< of the published curve from where an entry would begin
  ShownMotion shown_;
  BoardSegment read_;  ///< scratch
  KnotCopy knot_;      ///< scratch
  std::vector<core::Knot> knots_;
  std::vector<double> knot_values_;
  std::vector<double> values_;  ///< scratch
  core::Segment segment_;       ///< scratch
  Word run_ = 1;
  Word run_item_ = 0;  ///< item of the run's first waypoint, plus 1
  Word first_ = 0;
  Word newest_ = 0;
  Time rest_{};
  Time stop_{};  ///< length of the stop, if the newest segment is one
  Time changed_from_ = Time::max();
  std::size_t kept_ = 0;  ///< number of leading knots of the run unchanged since the commit
  std::size_t open_ = 0;  ///< number of leading knots of the run that are written with final values

  core::End end_;
  std::size_t met_ = 0;            ///< first knot of the run in the last piece of the target
  Word met_number_ = 1;            ///< its number
  std::size_t unmet_ = 0;          ///< first knot of the run that the open entry passes over
  std::size_t passed_lowest_ = 0;  ///< first knot that is written to the passed slots: up to
                                   ///< kMetKept before unmet_; 0 if a stream starts by an entry
  /// Number of leading knots of the run in the numbered slots, if the curve ends on the target.
  std::size_t placed_ = 0;
  /// Knots from passed_lowest_ to before this one are in the passed slots, unless newer ones are.
  std::size_t passed_written_ = 0;
  std::size_t passed_committed_ = 0;  ///< the same, as of the last commit
  Word passed_before_ = 0;            ///< waypoints passed over by entries that have ended
  CurveOrigin origin_;
  State origin_state_;
  Time blend_until_ = Time::min();  ///< no entry of the run ends before this time
  State beyond_;  ///< state at the end of the entry; only the acceleration if it ends at a waypoint
  bool is_entry_new_ = false;       ///< the entry has not been written
  bool is_prepared_ = false;        ///< this step has found the state from which an entry may begin
  bool uses_cut_ = false;           ///< that state is cut_.state(), else the origin
  Time unmet_since_ = Time::max();  ///< see Summary
  Time refused_until_ = Time::max();    ///< see Summary
  std::optional<Word> leaving_item_{};  ///< for this waypoint the curve searches where to leave
  std::size_t leaving_knot_ = 0;        ///< from this knot of the target
  FinishState finish_;                  ///< `entered`: the curve ends by an entry to `beyond_`
  std::size_t committed_knots_ = 0;     ///< number of knots of the run at the last commit
  bool has_changes_ = false;
  bool is_damaged_ = false;
};

}  // namespace splinecast::ipc
