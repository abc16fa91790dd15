#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "core/laws/rate_curve.hpp"
#include "core/online/sliding_window.hpp"
#include "ipc/board/reader.hpp"
#include "ipc/board/writer.hpp"
#include "ipc/layout/summary.hpp"
#include "ipc/requests/stopper_table.hpp"
#include "ipc/requests/stoppers.hpp"
#include "ipc/ring/item.hpp"
#include "ipc/ring/reader.hpp"
#include "ipc/runs/outcomes.hpp"
#include "ipc/solve/law_planner.hpp"
#include "ipc/solve/pauses.hpp"
#include "ipc/solve/published_curve.hpp"
#include "ipc/solve/replacement_queue.hpp"
#include "ipc/solve/settled_raise.hpp"
#include "splinecast/clock.hpp"
#include "splinecast/dimension_kind.hpp"
#include "splinecast/status.hpp"

namespace splinecast::ipc {

/// How a live stream is solved.
struct LiveOptions {
  Time settle_ahead{5'000'000};  ///< the curve before now + this never changes
  Time history{1'000'000'000};   ///< segments that end after now − this are not overwritten
  Time least_entry{5'000'000};   ///< length of the shortest entry
  bool follows_law = false;      ///< stream time passes by a time law
};

/// The solver without its regions: takes items from a ring, solves the window, and publishes knots
/// on a board. Has no thread and no clock of its own, so that tests with simulated time, fuzzers
/// and ThreadSanitizer run the production code. Allocates only when constructed; `step` never
/// blocks and makes no system call except the clock's.
///
/// On a live stream everything before `settled_until` = now + settle_ahead is frozen before a step
/// takes an item, up to the right end of the segment that contains that time. If a waypoint comes
/// when the newest knot has been frozen, an entry leads from settled_until onto the waypoints; an
/// entry also leads onto the waypoints of a replacement: see PublishedCurve. Directly before the
/// commit the clock is read again: a revision that would change a part of the curve that may have
/// been executed meanwhile is discarded and counted, and the next step solves it again.
///
/// All published values are finite: a revision with a NaN, an infinity or a value out of the range
/// that readers accept is discarded. The same step solves it again with fewer items, until the
/// offending item is alone and is refused.
///
/// On a stream with limits, the solver first tries each waypoint. If the curve with it exceeds a
/// limit, the solver records the excess, and takes or refuses the waypoint as `beyond` specifies.
///
/// A replacement takes effect at settled_until of the first step that finds it in the ring, or at
/// its own time if that is later, regardless of the items queued before it: it is never too late.
/// It passes over those of its waypoints that are before. A stop is a replacement without
/// waypoints; it does not wait for the room that the board has for the items before it.
///
/// While the time law of a stream holds it, its curve can be changed from the held time on, plus 1
/// ns, although more had settled: no process has executed more, or had more as a settled sample.
/// There a stop or a replacement as soon as possible (latest_from_rest()) cuts the curve, and
/// what follows begins at rest: a machine that rests stays where it is. A stop that is executed
/// when the law holds is cut there in the same way. For that the settled word goes back, in this
/// order: store the word, read the law again, commit. If the law no longer holds, the revision is
/// discarded and the word is stored again as it was. A reader, a recorder or a snapshot that takes
/// more than the held time as settled has read a later law than this solver, and reads the word
/// after the law: so it finds the lower word (tests/model/lowered_settled.pml). (In C++ terms that
/// needs fences on the reader's side too. Every processor on which a store becomes visible to all
/// others at once, as x86 and ARMv8 do, orders it without.) The time of the commit is compared with
/// the clock as for each revision.
///
/// While a stopper holds a live stream, the curve rests, or is in a stop: where it was not, one
/// begins in the first step that finds the request, as that of a producer, in a revision of its
/// own. Waypoints, start states and replacements with waypoints are refused; a stop and a finish
/// are taken. After the release a run begins with the next waypoint.
///
/// The solver of a time law plans the law itself, in each step: see plan_with(). Items that an
/// earlier step or solver has left in the ring are withdrawn first, because they were planned for a
/// time that has passed.
class StreamSolver {
 public:
  /// `board` and `published` are the writing and the reading side of one board; with `ring` they
  /// outlive the solver. `kinds` are those of the ring's dimensions; `live` is set for a live
  /// stream. Continues from the last commit on the board. Throws std::invalid_argument for window
  /// options out of range or a board too small for them, BadRegion if no solver can continue the
  /// curve on the board.
  StreamSolver(const WaypointRingReader& ring, KnotBoardWriter& board,
               const KnotBoardReader& published, const core::WindowOptions& window,
               const IntervalRange& intervals, DimensionKinds kinds = {},
               const std::optional<LiveOptions>& live = std::nullopt,
               Beyond beyond = Beyond::report);

  /// The stream is a time law, of which this is the planner; it outlives the solver.
  void plan_with(LawPlanner& planner) noexcept { planner_ = &planner; }

  /// A live stream heeds the requests of these stoppers, which outlive the solver.
  void heed(StopRequests& stoppers) noexcept { stoppers_ = &stoppers; }

  /// Whether a stopper holds the stream, as of the last step.
  [[nodiscard]] bool is_held() const noexcept { return stops_.holders() > 0; }

  /// Takes the items in the ring, up to a bounded batch, and publishes the result as one revision;
  /// on a recorded stream as two, if an entry precedes a replacement.
  /// On a live stream it also stores settled_until when that is due, without a new revision.
  /// O(batch·K·D). For any content of the ring, a step takes a bounded time and at most
  /// as many items as the ring has; invalid items are refused. Data read back from the board are
  /// checked as well.
  StepResult step(const Clock& clock) noexcept;

  /// The summary last committed.
  [[nodiscard]] const Summary& summary() const noexcept { return summary_; }

  /// The written position of the ring for which the last step left no work. A step has work to do
  /// when the ring's written position differs from it, or when `due` has come.
  [[nodiscard]] Word seen() const noexcept { return seen_; }

  /// Whether the last step has begun what the next item needs, and the next one continues it.
  [[nodiscard]] bool is_postponed() const noexcept { return step_.is_postponed; }

  /// Host time at which the next step is due even if no item comes; max() for never.
  [[nodiscard]] Time due() const noexcept;

  /// Prefetches the memory outside this object that the next step touches if it takes one waypoint.
  /// Loads none of it.
  void prefetch() const noexcept;

  /// Raises the settled time without a step, until a step has other work to do.
  [[nodiscard]] SettledRaise settled_raise() const noexcept;

  /// The smallest capacity of a board for a settle lag.
  [[nodiscard]] static std::size_t min_capacity(std::size_t settle) noexcept;

 private:
  /// What the current step knows, or the last one.
  struct Step {
    Time settled_until = Time::min();  ///< it changes nothing before this time
    Time keep = Time::max();           ///< it overwrites no segment that ends after this time
    bool is_timed = false;
    Time started{};                   ///< host time when it began, if it is timed
    std::optional<Time> held_from{};  ///< the earliest time at which a held law allows a change
    bool begins_held = false;         ///< a run begins at rest there in this revision
    bool has_starved = false;         ///< the stream has begun to starve
    int tries = 0;                    ///< candidates of an entry that it may still try
    bool is_postponed = false;  ///< the next item is taken in the next step, which is due at once
    Word available = 0;         ///< it takes items before this one
    Word batch = 0;             ///< items taken for this revision, one by one
    Word batch_limit = 0;       ///< maximum of `batch`
    std::optional<Word> entry_before{};  ///< the revision has no items: see enters_before()
  };

  /// What has made a revision unsound, which was discarded then.
  struct Unsound {
    Word until = 0;  ///< items before this one were in a discarded revision
    /// Current maximum of items per revision: max_batch_, or fewer after an unsound revision.
    Word most_items = 0;
    std::optional<Word> item{};   ///< the item that alone makes a revision unsound
    std::optional<Word> entry{};  ///< the replacement before which an entry is unsound
  };

  void restore();
  void freeze(const Clock& clock, Time now) noexcept;
  [[nodiscard]] StepResult make_revision(const Clock& clock, Time now) noexcept;
  void take_back(Word misses) noexcept;
  void suspect_items() noexcept;
  [[nodiscard]] Word consume(Time now) noexcept;
  void plan_law(Time now) noexcept;
  [[nodiscard]] Time time_of_cut(Time t) const noexcept;
  [[nodiscard]] bool can_rest() const noexcept;
  void rest_where_held() noexcept;
  [[nodiscard]] bool stops_where_held() noexcept;
  void begin_run(Time t, const RunBegin& how) noexcept;
  [[nodiscard]] bool is_damaged() const noexcept { return lacks_summary_ || curve_.is_damaged(); }
  [[nodiscard]] Word reachable(Word written) const noexcept;
  [[nodiscard]] bool enters_before(Word replacement) noexcept;
  [[nodiscard]] bool has_room(const RingItem& item) const noexcept;
  [[nodiscard]] bool withdraw() noexcept;
  /// Whether an item is a stop: a replacement without waypoints.
  [[nodiscard]] static bool is_stop(const RingItem& item) noexcept {
    return item.kind == ItemKind::replace && item.count == 0;
  }
  /// Whether an item would move the machine.
  [[nodiscard]] static bool moves(const RingItem& item) noexcept {
    return item.kind != ItemKind::finish && item.kind != ItemKind::rate && !is_stop(item);
  }
  void begin_where_left() noexcept;
  void handle(Word number) noexcept;
  void handle_waypoint(Word number) noexcept;
  [[nodiscard]] bool note_excess(const std::optional<LimitExcess>& excess, Word number) noexcept;
  void count_excess(std::optional<LimitExcess> excess, Word number, bool is_refused) noexcept;
  [[nodiscard]] std::optional<Refusal> append(const Waypoint& waypoint, Word number) noexcept;
  void handle_replacement(Word number) noexcept;
  void refuse_replacement(Word number, Refusal reason) noexcept;
  void handle_plan(Word number) noexcept;
  [[nodiscard]] std::optional<Refusal> read_plan(Word number, core::RateCurve& plan) noexcept;
  void handle_start_state(Word number) noexcept;
  void handle_finish(Word number) noexcept;
  [[nodiscard]] bool is_starved() const noexcept;
  [[nodiscard]] std::optional<Refusal> form_refusal(const Waypoint& waypoint) const noexcept;
  [[nodiscard]] std::optional<Refusal> time_refusal(Time time) const noexcept;
  void refuse(Word number, Refusal reason) noexcept;
  void check_commit(Time now) noexcept;
  void store_settled(Time t) noexcept;
  [[nodiscard]] Time settled_by_commit() const noexcept;
  void note_outcomes(const RunProgress& now, Word first) noexcept;
  void note_end(const RunProgress& now) noexcept;
  [[nodiscard]] bool still_rests(const Clock& clock) noexcept;
  StepResult publish(const Clock& clock, Word consumed) noexcept;

  const WaypointRingReader* ring_;
  KnotBoardWriter* board_;
  const KnotBoardReader* published_;
  IntervalRange intervals_;
  std::optional<LiveOptions> live_;
  Beyond beyond_;
  PublishedCurve curve_;
  Outcomes outcomes_;
  std::size_t max_batch_;
  Summary summary_;
  bool lacks_summary_ =
      false;  ///< the board has no summary of its revision: another process has changed it
  Step step_;
  Unsound unsound_;
  Time settled_at_ = Time::min();  ///< host time when settled_until was last stored
  Pauses pauses_;                  ///< of the steps of a live stream
  RingItem item_;
  Condition end_;
  Word seen_ = 0;
  ReplacementQueue replacements_;
  LawPlanner* planner_ = nullptr;  ///< of a time law
  StopRequests* stoppers_ = nullptr;
  StopperTable stops_;
  LawPlan plan_;              ///< of this revision
  bool has_refused_ = false;  ///< the revision has refused an item
};

}  // namespace splinecast::ipc
