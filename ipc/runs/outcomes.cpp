#include "ipc/runs/outcomes.hpp"

#include <algorithm>

#include "ipc/layout/knot_slots.hpp"

namespace splinecast::ipc {
namespace {

/// Waypoints of which a solver keeps the item: a revision that is discarded looks at all of them.
constexpr std::size_t kMostKept = 1U << 14;

}  // namespace

Outcomes::Outcomes(KnotBoardWriter& board, const KnotBoardReader& published)
    : board_(&board), published_(&published), taken_(std::min(published.capacity(), kMostKept)) {}

void Outcomes::take_over(const Summary& summary) noexcept {
  known_from_ = newest_ = summary.knots;
  if (!summary.finished) board_->lose_outcomes(summary.consumed);
}

void Outcomes::restore(const Summary& summary) noexcept {
  if (count_ != summary.outcomes) {
    for (Taken& waypoint : taken_) {
      if (waypoint.out >= summary.outcomes) waypoint.out = kNoItem;
    }
  }
  count_ = summary.outcomes;
  accepted_ = summary.knots;
  run_ = {.course = summary.finished ? Course::on_target : static_cast<Course>(summary.course),
          .knots = summary.run_knots,
          .met = summary.met,
          .unmet = summary.unmet};
}

void Outcomes::accept(Word item, Time time) noexcept {
  taken_[place_of(accepted_++)] = {.item = item, .time = time};
  newest_ = std::max(newest_, accepted_);
}

Word Outcomes::oldest_kept() const noexcept {
  const Word size = taken_.size();
  return std::max(known_from_, newest_ - std::min(newest_, size));
}

void Outcomes::note_in_force(Word item, OutcomeWay way, Time time) noexcept {
  record({.item = item, .kind = OutcomeKind::in_force, .way = way, .time = time, .first = item});
}

/// An entry ends at waypoint `knot` of the run, at its own time.
void Outcomes::meet(const RunProgress& run, Word knot) noexcept {
  const Word index = index_of(run, knot);
  if (index < oldest_kept()) return;
  note_in_force(taken(index).item, OutcomeWay::entry, taken(index).time);
}

/// Records that the accepted waypoints `first` to `end` - 1 are not in force. Of those that are not
/// kept the outcome is lost.
void Outcomes::take_out(Word first, Word end, OutcomeKind kind) noexcept {
  const Word oldest = oldest_kept();
  if (first >= end || end > accepted_) return;
  if (first < oldest && oldest < accepted_) board_->lose_outcomes(taken(oldest).item);
  first = std::max(first, oldest);
  if (first >= end) return;
  for (Word i = first; i < end; ++i) taken_[place_of(i)].out = count_;
  record({.item = taken(end - 1).item, .kind = kind, .first = taken(first).item});
}

void Outcomes::advance(const RunProgress& now) noexcept {
  const Word begin = index_of(now, 0);
  if (!run_.is_interpolated() && now.unmet > run_.unmet) {
    take_out(begin + run_.unmet, begin + now.unmet - 1, OutcomeKind::passed_over);
    meet(now, now.unmet - 1);
  }
  const bool was_entering = run_.course == Course::entering && run_.met == now.met;
  if (now.course == Course::entering && !was_entering) {
    take_out(begin + now.unmet, begin + now.met, OutcomeKind::passed_over);
    meet(now, now.met);
  }
  run_ = now;
}

/// The end of the accepted waypoints from `first` to `end` - 1 that are not later than t.
Word Outcomes::end_until(Word first, Word end, Time t) const noexcept {
  first = std::max(first, oldest_kept());
  end = std::min(end, accepted_);
  while (end > first && taken(end - 1).time > t) --end;
  return end;
}

/// Withdraws the waypoints before `end` that are in force after t.
void Outcomes::withdraw(Word end, Time t) noexcept {
  const Word oldest = oldest_kept();
  Word last = std::min(end, accepted_);  // those from i to last - 1 are in force
  for (Word i = last; i > oldest; --i) {
    const Taken& waypoint = taken(i - 1);
    if (waypoint.out == kNoItem && waypoint.time > t) continue;
    take_out(i, last, OutcomeKind::withdrawn);
    if (waypoint.out == kNoItem) return;
    last = i - 1;
  }
  take_out(oldest, last, OutcomeKind::withdrawn);
  // All that are kept are later, and so may be older ones.
  if (oldest > 0 && oldest < accepted_) board_->lose_outcomes(taken(oldest).item);
}

/// Withdraws the items that the records say are in force after t: replacements, and waypoints that
/// another solver took.
void Outcomes::withdraw_recorded(Time t) noexcept {
  const Word end = count_;
  const Word kept = std::min<Word>(end, kOutcomesKept);
  for (Word back = 1; back <= kept; ++back) {
    const auto found = published_->outcome(end - back);
    if (!found || found->kind != OutcomeKind::in_force || found->time <= t) continue;
    bool is_newest = true;
    for (Word i = end - back + 1; i < count_ && is_newest; ++i) {
      const auto newer = published_->outcome(i);
      is_newest = !newer || !newer->is_of(found->item);
    }
    if (!is_newest) continue;
    record({.item = found->item, .kind = OutcomeKind::withdrawn, .first = found->item});
  }
}

void Outcomes::cut(const RunProgress& now, Time t) noexcept {
  advance(now);
  const Word begin = index_of(now, 0);
  Word open = begin + now.decided();
  const Word goal = begin + now.goal;
  if (now.goal > now.decided() && end_until(goal - 1, goal, t) == goal) {
    take_out(open, goal - 1, OutcomeKind::passed_over);
    meet(now, now.goal - 1);
    open = goal;
  }
  const Word over = end_until(open, accepted_, t);
  take_out(over, accepted_, OutcomeKind::withdrawn);
  take_out(open, over, OutcomeKind::passed_over);
  withdraw(open, t);
  withdraw_recorded(t);
  run_ = {.course = Course::waiting};
}

void Outcomes::end(const RunProgress& now, const RunEnd& how) noexcept {
  note_in_force(how.item, OutcomeWay::end, how.rest);
  run_ = now;
  run_.course = Course::on_target;  // nothing is undecided
  if (now.knots == 0) return;
  const Word begin = index_of(now, 0);
  const Word last = now.knots - 1;
  if (how.kind == EndKind::slowed) (void)note_at_end(now, 0, how.rest);
  if (how.kind == EndKind::in_stop && !now.is_interpolated()) {
    take_out(begin + now.unmet, accepted_, OutcomeKind::passed_over);
  }
  const bool enters = how.kind == EndKind::entered;
  if (!enters && (how.kind != EndKind::as_requested || now.is_interpolated())) return;
  take_out(begin + now.unmet, begin + last, OutcomeKind::passed_over);
  if (now.unmet > last) return;
  // A curve that rested there before the end was requested may have come after the waypoint's time.
  const Time own = taken(begin + last).time;
  (void)note_at_end(now, 0, enters ? how.rest : std::max(own, how.rest));
}

bool Outcomes::note_at_end(const RunProgress& now, Word newer, Time time) noexcept {
  if (newer >= now.knots) return false;
  const Word index = index_of(now, now.knots - 1 - newer);
  if (index < oldest_kept()) return false;
  const Taken& waypoint = taken(index);
  if (newer > 0 && time == waypoint.time) return false;
  note_in_force(waypoint.item, OutcomeWay::end, time);
  return true;
}

void Outcomes::put(Summary& summary) const noexcept {
  summary.outcomes = count_;
  const Word index = std::max(index_of(run_, run_.decided()), oldest_kept());
  summary.undecided = index < accepted_ ? taken(index).item : kNoItem;
}

}  // namespace splinecast::ipc
