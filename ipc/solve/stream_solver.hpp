#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "core/online/sliding_window.hpp"
#include "ipc/board/reader.hpp"
#include "ipc/board/writer.hpp"
#include "ipc/layout/summary.hpp"
#include "ipc/ring/item.hpp"
#include "ipc/ring/reader.hpp"
#include "ipc/solve/published_curve.hpp"
#include "ipc/solve/replacement_queue.hpp"
#include "ipc/solve/settled_raise.hpp"
#include "splinecast/clock.hpp"
#include "splinecast/dimension_kind.hpp"
#include "splinecast/status.hpp"

namespace splinecast::ipc {

/// How a live stream is solved.
struct LiveOptions {
  Time freeze_ahead{5'000'000};  ///< what lies this long before now + this never changes
  Time history{1'000'000'000};   ///< what ends after now − this is not overwritten
  Time min_splice{5'000'000};    ///< length of the shortest splice
};

/// The solver without its regions: takes items from a ring, solves the window, publishes knots on a
/// board. Without a thread or a clock of its own, so that simulated time, fuzzers and
/// ThreadSanitizer drive the code that runs for real. Allocates when made only; `step` never blocks
/// and makes no system call but the clock's.
///
/// On a live stream everything before `settled_until` = now + freeze_ahead is frozen: before a step
/// takes anything, up to the right end of the segment that contains that time. Where a waypoint
/// comes when the newest knot has been frozen, an entry leads from settled_until back to the
/// waypoints, and so it does to what replaces the future: see PublishedCurve. Directly before the
/// commit the clock is read again: a revision that would change what may have been executed
/// meanwhile is discarded, counted and made anew.
///
/// What is published is finite: a revision with a value that is no number, or beyond what readers
/// accept, is discarded and made again with fewer items, until the one that it comes from is alone
/// and is refused.
///
/// Of a stream with limits each waypoint is tried first: where the curve would pass a limit with
/// it, that is noted, and the waypoint is taken or refused, as `beyond` has it.
///
/// A stop, a replacement without waypoints, takes effect at settled_until of the first step that
/// finds it in the ring, or at its own time if that is later: whatever is queued before it, whether
/// or not the board has room for those items.
class StreamSolver {
 public:
  /// `board` and `published` are the writing and the reading side of one board; with `ring` they
  /// outlive the solver. `kinds` are those of the ring's dimensions; `live` is set for a live
  /// stream. Goes on where the board says that a solver before it stood. Throws
  /// std::invalid_argument for window options out of range or a board too small for them, BadRegion
  /// if the board holds no curve that a solver can go on with.
  StreamSolver(const WaypointRingReader& ring, KnotBoardWriter& board,
               const KnotBoardReader& published, const core::WindowOptions& window,
               const IngestLimits& limits, DimensionKinds kinds = {},
               const std::optional<LiveOptions>& live = std::nullopt,
               Beyond beyond = Beyond::report);

  /// Takes what the ring holds, up to a bounded batch, and publishes the result as one revision; on
  /// a live stream also says how far the curve is settled, when that is due, which is no revision.
  /// O(batch·K·D). Whatever the ring holds, a step takes a bounded time and no more items than the
  /// ring has; what is no item is refused. What it reads back of the board is checked as well.
  StepResult step(const Clock& clock) noexcept;

  /// The head last committed.
  [[nodiscard]] const Head& head() const noexcept { return head_; }

  /// The ring's `head` when the last step found nothing more that it could take. A step is of use
  /// once it has changed, or `due` has come.
  [[nodiscard]] Word seen() const noexcept { return seen_; }

  /// When the next step is due even if no item comes; max() for never.
  [[nodiscard]] Time due() const noexcept;

  /// Asks for the memory outside this object that the next step goes through if it takes one
  /// waypoint. Loads nothing of that.
  void prefetch() const noexcept;

  /// What can be done without a step until the next one is of use for more.
  [[nodiscard]] SettledRaise settled_raise() const noexcept;

  /// The smallest board for a settle lag.
  [[nodiscard]] static std::size_t min_capacity(std::size_t settle) noexcept;

 private:
  void restore();
  void freeze(Time now) noexcept;
  [[nodiscard]] StepResult make_revision(const Clock& clock, Time now) noexcept;
  void take_back(Word misses) noexcept;
  void suspect_items() noexcept;
  [[nodiscard]] Word consume(Time now) noexcept;
  [[nodiscard]] bool is_damaged() const noexcept { return lacks_head_ || curve_.is_damaged(); }
  [[nodiscard]] Word reachable(Word head) const noexcept;
  [[nodiscard]] bool has_room(const RingItem& item) const noexcept;
  void withdraw() noexcept;
  /// Whether an item is a stop: a replacement without waypoints.
  [[nodiscard]] static bool is_stop(const RingItem& item) noexcept {
    return item.kind == ItemKind::replace && item.count == 0;
  }
  void take(Word number) noexcept;
  void take_waypoint(Word number) noexcept;
  [[nodiscard]] Waypoint unwrapped(const Waypoint& given) noexcept;
  [[nodiscard]] bool note_excess(const Waypoint& waypoint, Word number) noexcept;
  void take_replacement(Word number) noexcept;
  void refuse_replacement(Word number, Refusal reason) noexcept;
  void take_start_state(Word number) noexcept;
  void take_finish(Word number) noexcept;
  [[nodiscard]] bool is_starved() const noexcept;
  [[nodiscard]] std::optional<Refusal> form_refusal(const Waypoint& waypoint) const noexcept;
  [[nodiscard]] std::optional<Refusal> time_refusal(Time time) const noexcept;
  void refuse(Word number, Refusal reason) noexcept;
  void check_commit(Time now) noexcept;
  void store_settled(Time t) noexcept;
  [[nodiscard]] Time settled_by_commit() const noexcept;
  StepResult publish(const Clock& clock, Word consumed) noexcept;

  const WaypointRingReader* ring_;
  KnotBoardWriter* board_;
  const KnotBoardReader* published_;
  IngestLimits limits_;
  std::optional<LiveOptions> live_;
  Beyond beyond_;
  PublishedCurve curve_;
  std::size_t max_batch_;
  Head head_;
  bool lacks_head_ = false;  ///< the board has none of its revision: somebody else wrote to it
  Time settled_until_ = Time::min();  ///< what this step leaves alone lies before it
  Time keep_ = Time::max();           ///< what ends after it this step does not overwrite
  bool is_timed_ = false;             ///< this step
  Time started_{};                    ///< the clock when it began, if it is timed
  Time settled_at_ = Time::min();     ///< the clock when settled_until was last stored
  bool has_starved_ = false;          ///< in this step
  int tries_ = 0;                     ///< candidates of an entry that this step may still try
  bool is_finish_postponed_ = false;  ///< no entry to the last waypoint has been found yet
  RingItem item_;
  std::vector<double> unwrapped_;  ///< scratch: position, velocity, acceleration
  Condition end_;
  Word seen_ = 0;
  Word batch_ = 0;        ///< items taken for this revision, one by one
  Word batch_limit_ = 0;  ///< of this revision
  Word suspected_ = 0;    ///< items before this one were in a revision that was not finite
  Word most_items_ =
      0;  ///< of a revision, at this time: max_batch_, or fewer behind an unsound one
  std::optional<Word> unsound_item_{};  ///< the item that alone makes a revision unsound
  Word available_ = 0;                  ///< how far this step can take items
  ReplacementQueue replacements_;
};

}  // namespace splinecast::ipc
