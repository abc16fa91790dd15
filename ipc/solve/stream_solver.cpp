#include "ipc/solve/stream_solver.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

#include "splinecast/errors.hpp"

namespace splinecast::ipc {
namespace {

/// Maximum number of items of one revision: bounds the duration of a step.
constexpr std::size_t kMaxBatch = 256;

/// Knots that a revision may write in addition to one per item: the open ones, the one before them,
/// those at a cut, and those of an entry.
constexpr std::size_t changed_knots(std::size_t settle) noexcept { return settle + 6; }

/// On a recorded stream, which does not depend on the clock, one step out of this many is timed.
constexpr Word kTimedEvery = 16;

/// Knots that one item may add: those at a cut, its own, those of an entry, and those of a stop
/// after it, because a stop does not wait for room.
constexpr std::size_t kAddedByItem = 4 + PublishedCurve::kAddedByStop;

}  // namespace

std::size_t StreamSolver::min_capacity(std::size_t settle) noexcept {
  return 2 * changed_knots(settle) + 2;
}

StreamSolver::StreamSolver(const WaypointRingReader& ring, KnotBoardWriter& board,
                           const KnotBoardReader& published, const core::WindowOptions& window,
                           const IntervalRange& intervals, DimensionKinds kinds,
                           const std::optional<LiveOptions>& live, Beyond beyond)
    : ring_(&ring),
      board_(&board),
      published_(&published),
      intervals_(intervals),
      live_(live),
      beyond_(beyond),
      curve_(board, published, window, std::move(kinds),
             {.is_live = live.has_value(),
              .least_entry = live ? live->least_entry : Time::zero(),
              .notice = live ? live->settle_ahead : Time::zero(),
              .keeps_limits = live && beyond == Beyond::enter,
              .checks_stops = live && beyond != Beyond::report}),
      outcomes_(board, published),
      max_batch_(std::min(kMaxBatch, board.capacity() / 2 - changed_knots(window.settle))),
      item_(ring.dimensions()),
      replacements_(ring) {
  if (board.capacity() < min_capacity(window.settle)) {
    throw std::invalid_argument("a board of " + std::to_string(board.capacity()) +
                                " knots is too small for settle lag " +
                                std::to_string(window.settle));
  }
  end_.value.reserve(ring.dimensions());
  unsound_.most_items = max_batch_;
  restore();
  if (is_damaged() || board.revision() >= kLastRevision) {
    throw BadRegion("no solver can continue the curve on the board at its revision " +
                    std::to_string(board.revision()));
  }
  // The last writer may have died between its commit and the stores after it.
  board_->store_consumed(summary_.consumed);
  board_->store_holders(summary_.holders);
  outcomes_.take_over(summary_);
  if (!live_ && curve_.has_begun() && !summary_.finished)
    store_settled(curve_.plan().settled_until());
}

void StreamSolver::restore() {
  summary_ = {};
  const Look look = published_->look();
  lacks_summary_ =
      look.revision > 0 && !published_->copy_summary(look, summary_);  // fails on damage only
  curve_.restore(summary_);
  outcomes_.restore(summary_);
  stops_.restore(board_->next_stoppers().first<kStopperTableWords>(), summary_.holders);
}

Time StreamSolver::due() const noexcept {
  if (live_ && (curve_.is_planning() || step_.is_postponed)) return settled_at_;
  const bool settles = live_ && !summary_.finished && summary_.newest > 0 &&
                       summary_.settled_until < curve_.end_of_motion();
  const bool waits = live_ && seen_ != summary_.consumed;
  return settles || waits ? settled_at_ + live_->settle_ahead / 2 : Time::max();
}

void StreamSolver::prefetch() const noexcept {
  ring_->prefetch(summary_.consumed);
  curve_.prefetch();
}

SettledRaise StreamSolver::settled_raise() const noexcept {
  const bool settles = live_ && !live_->follows_law && !summary_.finished && !summary_.starved &&
                       summary_.newest > 0;
  const bool is_busy = curve_.is_planning() || core::is<core::Waiting>(curve_.plan().end());
  if (!settles || is_busy || seen_ != summary_.consumed) return {};
  const Time limit =
      std::min({curve_.plan().newest_time(), curve_.end_of_motion(), curve_.start_decision()});
  return {board_->settled_word(), summary_.settled_until, live_->settle_ahead, limit};
}

StepResult StreamSolver::step(const Clock& clock) noexcept {
  if (is_damaged()) return {.damaged = true};
  if (live_) summary_.settled_until = std::max(summary_.settled_until, board_->resume_settled());
  step_.is_timed = live_ || board_->revision() % kTimedEvery == 0;
  const Time was_due = due();
  const Time began = step_.is_timed ? clock.now() : Time::min();
  if (step_.is_timed) step_.started = clock.host_time(began);
  const bool is_late = settled_at_ > Time::min() && was_due < step_.started;
  if (is_late) pauses_.note(step_.started, step_.started - was_due);
  const Time now = live_ ? began : Time::min();
  if (live_ && !board_->is_checked()) check_commit(now);
  // Each try takes half as many items as the one before. If a try with one item fails, the next try
  // refuses that item.
  constexpr int kMostTries = 12;
  static_assert(kMaxBatch < 1U << (kMostTries - 2));
  for (int i = 0; i < kMostTries; ++i) {
    const StepResult result = make_revision(clock, now);
    const bool is_sound = board_->is_sound();
    // On a live stream the replacement after an entry is taken in the next step, which is due.
    if (is_sound && (live_ || !step_.entry_before)) return result;
    if (!is_sound) suspect_items();
    if (is_damaged()) return {.damaged = true};
  }
  return {};
}

/// Takes the next items and publishes the result as a revision, unless it is unsound.
StepResult StreamSolver::make_revision(const Clock& clock, Time now) noexcept {
  freeze(clock, now);
  const Word consumed = consume(now);
  if (is_damaged()) return {.damaged = true};
  const bool has_news = step_.has_starved || plan_.must_commit || stops_.has_changes();
  if (consumed > 0 || curve_.has_changes() || has_news) return publish(clock, consumed);
  if (!live_ || step_.started < due()) return {};
  settled_at_ = step_.started;
  // Only the settled time has changed: stores that word, and readers keep their copies.
  if (summary_.newest > 0) store_settled(step_.settled_until);
  return {};
}

void StreamSolver::store_settled(Time t) noexcept {
  summary_.settled_until = std::max(summary_.settled_until, t);
  board_->store_settled(summary_.settled_until);
}

/// Discards a revision that was not committed.
void StreamSolver::take_back(Word misses) noexcept {
  board_->discard();
  restore();
  summary_.deadline_misses = misses;
  seen_ = summary_.consumed;
}

/// Discards an unsound revision, and halves the number of items of the next one. If the revision
/// had only one item, marks that item to be refused. If it had only the entry before a replacement,
/// the replacement is taken without it. A revision with neither is sound: the knots of other
/// entries and of stops have values that sound revisions have had.
void StreamSolver::suspect_items() noexcept {
  unsound_.until = std::max(unsound_.until, summary_.consumed);
  if (step_.entry_before) {
    unsound_.entry = step_.entry_before;
  } else if (step_.batch > 1) {
    unsound_.most_items = std::max<Word>(std::min<Word>(step_.batch, max_batch_) / 2, 1);
  } else {
    unsound_.item = summary_.consumed - 1;
  }
  take_back(summary_.deadline_misses);
}

/// Sets step_.settled_until for this step, freezes the curve before it, and counts starvation.
void StreamSolver::freeze(const Clock& clock, Time now) noexcept {
  step_.settled_until = summary_.settled_until;
  step_.has_starved = false;
  if (!live_) return;
  step_.settled_until = std::max(step_.settled_until, clock.latest(now, live_->settle_ahead));
  step_.begins_held = false;
  step_.held_from.reset();
  if (const auto held = clock.held()) step_.held_from = *held + Time(1);
  if (!curve_.has_begun() || summary_.finished) return;
  curve_.freeze(step_.settled_until);
  summary_.low_water =
      std::min(summary_.low_water, std::max(Time::zero(), curve_.plan().newest_time() - now));
  if (summary_.starved || !is_starved()) return;
  step_.has_starved = true;
  count_excess(curve_.stop_excess(), summary_.consumed - 1, false);
  summary_.starved = true;
  ++summary_.underruns;
}

/// Whether no part of the run may change any more, so that an entry must lead to the next waypoint.
bool StreamSolver::is_starved() const noexcept {
  // Nothing has settled before the first commit.
  if (!live_ || summary_.newest == 0) return false;
  return curve_.window().knots() > 0 ? step_.settled_until >= curve_.plan().newest_time()
                                     : step_.settled_until > curve_.plan().newest_time();
}

/// The end of the items that this step may take, if the ring's written position is `written`. Never
/// before the consumed position, and at most the ring's capacity after it, for any value in the
/// ring.
Word StreamSolver::reachable(Word written) const noexcept {
  const Word waiting = written - summary_.consumed;
  const bool goes_back = waiting > std::numeric_limits<Word>::max() / 2;
  return summary_.consumed + (goes_back ? 0 : std::min<Word>(waiting, ring_->capacity()));
}

Word StreamSolver::consume(Time now) noexcept {
  const Word before = summary_.consumed;
  if (planner_ != nullptr) plan_law(now);
  const Word written = ring_->written();
  step_.available = reachable(written);
  step_.keep = live_ ? now - live_->history : Time::max();
  rest_where_held();
  step_.entry_before.reset();
  step_.tries = PublishedCurve::kTriesPerStep;
  step_.batch_limit = unsound_.most_items;
  step_.batch = 0;
  step_.is_postponed = stops_where_held();
  bool is_blocked = step_.is_postponed || (!is_held() && withdraw());
  while (!is_blocked && summary_.consumed < step_.available && step_.batch < step_.batch_limit &&
         !is_damaged()) {
    ring_->copy(summary_.consumed, item_);
    // While a stopper holds the stream, no item adds a knot.
    is_blocked = !is_held() && (enters_before(summary_.consumed) || !has_room(item_));
    if (is_blocked) break;
    handle(summary_.consumed++);
    if (step_.is_postponed) {
      --summary_.consumed;
      break;
    }
    ++step_.batch;
    curve_.advance_search(step_.settled_until, step_.keep, false, step_.tries);
    // The next waypoint would push an untried candidate out of the window.
    if (curve_.is_planning() && step_.tries <= 0) break;
  }
  // No further waypoint can be taken: searches with the known ones.
  if (is_blocked || summary_.consumed == step_.available) {
    curve_.advance_search(step_.settled_until, step_.keep, true, step_.tries);
  }
  const bool waits = is_blocked && summary_.consumed == before && !curve_.has_changes();
  seen_ = waits || step_.available == before ? written : summary_.consumed;
  return summary_.consumed - before;
}

/// Withdraws what an earlier step or solver has left in the ring, and plans from the settled time
/// on.
void StreamSolver::plan_law(Time now) noexcept {
  const Word left = reachable(ring_->written()) - summary_.consumed;
  summary_.withdrawn += left;
  summary_.consumed += left;
  has_refused_ = false;
  plan_ = planner_->plan(now, step_.settled_until);
}

/// Whether the curve enters onto the waypoints before the replacement with this number, which is
/// taken in the next revision then. The entry is a revision of its own, so that it does not depend
/// on when the waypoints were taken. The item has been copied.
bool StreamSolver::enters_before(Word replacement) noexcept {
  if (item_.kind != ItemKind::replace || replacement == unsound_.entry) return false;
  if (curve_.may_enter_before(item_.time)) {
    if (step_.batch > 0) return true;
    curve_.enter_before_cut(step_.settled_until, step_.keep);
  } else if (!curve_.decide_start(time_of_cut(item_.time), step_.settled_until, step_.keep,
                                  step_.tries)) {
    return false;
  }
  if (step_.batch == 0 && curve_.has_changes()) step_.entry_before = replacement;
  step_.is_postponed = live_ && step_.entry_before;
  return curve_.has_changes();
}

/// Whether an item can be taken in this revision without losing the history that must be kept. A
/// replacement cuts the committed curve only, so it must be the first change of a revision. A law
/// does not wait for room: its history is shorter if more than a board of plans comes.
bool StreamSolver::has_room(const RingItem& item) const noexcept {
  if (item.kind == ItemKind::rate) return !curve_.has_changes();
  if (item.kind != ItemKind::replace) return curve_.has_room(kAddedByItem, step_.keep);
  if (curve_.has_changes()) return false;
  // A stop costs at most one segment of the history: it does not wait for room.
  return is_stop(item) || !curve_.has_begun() ||
         curve_.has_room_to_cut(time_of_cut(item.time), kAddedByItem, step_.keep);
}

/// Searches the ring for a replacement that is due, and withdraws all items queued before it. They
/// may be replacements that are not yet due, and waypoints for which the board has no room.
/// Withdraws nothing if the replacement itself must wait: for room, which the items before it may
/// use meanwhile, or for the commit of a change or of a start before it. Returns whether it waits
/// for a commit, so that no item is taken before that.
bool StreamSolver::withdraw() noexcept {
  if (!curve_.has_begun() || summary_.finished) return false;
  replacements_.note(summary_.consumed, step_.available);
  if (replacements_.empty()) return false;
  const auto replacement = replacements_.due(time_of_cut(Time::min()), curve_.plan().newest_time());
  if (!replacement) return false;
  ring_->copy(*replacement, item_);
  if (!has_room(item_)) return curve_.has_changes();
  if (live_ && enters_before(*replacement)) return true;
  if (*replacement > summary_.consumed) {
    outcomes_.record(
        {.item = *replacement - 1, .kind = OutcomeKind::withdrawn, .first = summary_.consumed});
  }
  summary_.withdrawn += *replacement - summary_.consumed;
  summary_.consumed = *replacement;
  return false;
}

/// Records on the board whether the last commit was late, because the process was stopped between
/// reading the clock and the commit. Readers detect it by changed_from. Stores it immediately,
/// because the next revision may be discarded, may never come, or may be another solver's.
void StreamSolver::check_commit(Time now) noexcept {
  const bool is_late = summary_.changed_from <= now && summary_.changed_from < Time::max();
  if (is_late && !board_->is_late()) ++summary_.late_commits;
  board_->store_checked(is_late);
}

/// The time to store as settled_until after a commit: the committed curve never changes before it.
Time StreamSolver::settled_by_commit() const noexcept {
  if (!live_) return curve_.plan().settled_until();
  // A finished curve no longer changes: it has settled to its end.
  return summary_.finished
             ? std::min(std::max(step_.settled_until, curve_.end_of_motion()), kLatestTime)
             : step_.settled_until;
}

/// Lowers the settled word to where a run begins at rest, and reads the law again. If it does not
/// hold there any more, the word becomes what it was.
bool StreamSolver::still_rests(const Clock& clock) noexcept {
  const Time settled = std::exchange(summary_.settled_until, *step_.held_from);
  board_->lower_settled(*step_.held_from);
  (void)clock.now();
  const auto held = clock.held();
  if (held && *held + Time(1) == *step_.held_from) return true;
  board_->store_settled(settled);
  return false;
}

StepResult StreamSolver::publish(const Clock& clock, Word consumed) noexcept {
  summary_.changed_from = curve_.write();
  if (!board_->is_sound()) return {};
  curve_.write_summary(summary_);
  if (planner_ == nullptr) note_outcomes(curve_.progress(), summary_.consumed - consumed);
  // The commit time of a recorded stream is not compared with anything.
  const bool is_free = !step_.begins_held || still_rests(clock);
  summary_.committed =
      step_.is_timed ? clock.now() : std::max(summary_.committed, clock.about_now());
  if (!is_free || (live_ && summary_.changed_from <= summary_.committed)) {
    take_back(summary_.deadline_misses + 1);
    return {.missed = true};
  }
  if (live_) {
    const Time committed = clock.host_time(summary_.committed);
    pauses_.note(committed, committed - step_.started);
    summary_.longest_pause = pauses_.longest(committed);
  }
  // A table without the plan that belongs to it would show what is not in force.
  if (planner_ != nullptr)
    board_->set_commanders(has_refused_ ? std::span<const Word>{} : plan_.table);
  if (stops_.has_changes()) board_->set_stoppers(stops_.words());
  board_->commit(summary_);
  if (stops_.has_changes()) board_->store_holders(summary_.holders);
  stops_.committed();
  settled_at_ = step_.started;
  if (summary_.newest > 0) store_settled(settled_by_commit());
  board_->store_consumed(summary_.consumed);
  if (step_.is_timed) board_->count_step(clock.host_time(summary_.committed) - step_.started);
  curve_.committed(summary_);
  unsound_.most_items = std::min<Word>(2 * unsound_.most_items, max_batch_);
  const bool changes = summary_.changed_from < Time::max();
  if (live_) check_commit(changes ? clock.now() : summary_.committed);
  return {.consumed = consumed, .published = true};
}

}  // namespace splinecast::ipc
