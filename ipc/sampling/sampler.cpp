#include "ipc/sampling/sampler.hpp"

#include <algorithm>
#include <utility>

#include "core/polynomial/segment.hpp"
#include "ipc/sampling/comparison.hpp"
#include "ipc/sampling/lookup.hpp"
#include "ipc/sampling/seconds.hpp"
#include "ipc/sampling/segment_values.hpp"

namespace splinecast::ipc {
Sampler::Sampler(const KnotBoardReader& board, StreamClock clock, DimensionKinds kinds)
    : board_(&board),
      clock_(clock),
      kinds_(std::move(kinds)),
      all_linear_(kinds_.all_linear()),
      kept_(board.dimensions(), board.smooths()),
      state_(board.dimensions()),
      start_acceleration_(board.dimensions()),
      end_acceleration_(board.dimensions()) {}

/// The sample at t. Usually nothing has been published since the last one, and t is in the segment
/// used last: then no lookup is needed.
inline SampleStatus Sampler::find(Time t, const StateRef& out) noexcept {
  if (is_gone()) return SampleStatus::retired;
  const Look look = board_->look();
  const bool is_in_current = look.revision == kept_.confirmed_by() &&
                             t >= kept_.current_interval().left &&
                             t < kept_.current_interval().right;
  if (!is_in_current && (look.revision != kept_.confirmed_by() || !continues(t)))
    return look_up(t, out);
  summary_.settled_until = look.settled_until;
  kept_.see_settled(look.settled_until);
  const BoardSegment& own = kept_.current();
  core::evaluate(own.order(), own.coefficients(),
                 seconds_after(kept_.current_interval().left, t) + fraction_, out);
  if (!all_linear_) kinds_.normalise(out);
  if (kept_.current_interval().is_finished) return SampleStatus::settled;
  return t < look.settled_until ? SampleStatus::settled : SampleStatus::provisional;
}

/// A sample that counts as executed.
inline SampleStatus Sampler::execute(Time t, const StateRef& out) noexcept {
  const SampleStatus status = find(t, out);
  if (clock_ == StreamClock::recorded || !has_values(status)) return status;
  const bool is_revised = revised_;
  sampled_until_ = is_revised ? t : std::max(sampled_until_, t);
  revised_ = false;
  return is_revised ? SampleStatus::revised : status;
}

SampleStatus Sampler::sample(Time t, const StateRef& out) noexcept {
  return fits(out) ? execute(t, out) : SampleStatus::wrong_dimension;
}

SampleStatus Sampler::sample(Time t, State& out) noexcept {
  const bool fits = out.dimensions() == board_->dimensions();
  return fits ? execute(t, out.ref()) : SampleStatus::wrong_dimension;
}

/// If t is after the current segment, makes the next segment of the same revision the current one.
/// Returns whether t is in that segment and it is not a stop or a hold.
bool Sampler::continues(Time t) noexcept {
  const BoardSegment& own = kept_.current();
  if (kept_.confirmed_by() != summary_.revision || !own.is_there() || t < own.right()) return false;
  const Word next = own.next();
  if (next > summary_.newest || !kept_.take(*board_, summary_, next)) return false;
  return t >= kept_.current_interval().left && t < kept_.current_interval().right;
}

/// Copies the bounds of a revision. Sets `revised_` if it, or an earlier one that this reader has
/// not seen, changed the curve before a time that this reader has sampled. Returns false if the
/// writer overtook it.
bool Sampler::see(const Look& look) noexcept {
  const Summary before = summary_;
  if (!board_->copy_bounds(look, before.revision, summary_)) return false;
  if (revised_ || before.revision == 0 || sampled_until_ < summary_.changed_from) return true;
  if (summary_.changed_from > Time::min()) {
    revised_ = true;
    return true;
  }
  // This reader has missed more revisions than kChangesKept.
  if (sampled_until_ < before.settled_until) return true;
  const BoardSegment& own = kept_.current();
  const bool is_known = kept_.confirmed_by() == before.revision && own.is_there();
  const Compared compared =
      compare_curve(*board_, summary_, {before, is_known ? &own : nullptr, sampled_until_},
                    kept_.spare(), state_.ref().position);
  if (compared == Compared::torn) {
    summary_ = before;
    return false;
  }
  revised_ = compared == Compared::changed;
  return true;
}

SampleStatus Sampler::preview(Time t, const StateRef& out) noexcept {
  return fits(out) ? find(t, out) : SampleStatus::wrong_dimension;
}

SampleStatus Sampler::sample(Time t, double fraction, const StateRef& out) noexcept {
  fraction_ = fraction;
  const SampleStatus status = sample(t, out);
  fraction_ = 0;
  return status;
}

SampleStatus Sampler::preview(Time t, double fraction, const StateRef& out) noexcept {
  fraction_ = fraction;
  const SampleStatus status = preview(t, out);
  fraction_ = 0;
  return status;
}

/// Makes summary_ the summary of the newest revision, and prefetches the knots around t, which the
/// caller looks up next. Returns `settled` if there is a curve, `busy` if the writer overtook it,
/// else the reason why there is no curve.
SampleStatus Sampler::see_newest(Time t) noexcept {
  if (is_gone()) return SampleStatus::retired;
  const Look look = board_->look();
  if (look.revision == 0) return SampleStatus::no_data;
  if (look.revision == summary_.revision) {
    summary_.settled_until = look.settled_until;
  } else {
    const Word likely = number_near(kept_.current(), t);
    board_->prefetch(look.revision, likely != 0 ? likely : kept_.current().number());
    if (!see(look)) return SampleStatus::busy;
  }
  return summary_.newest == 0 ? SampleStatus::no_data : SampleStatus::settled;
}

SampleStatus Sampler::look_up(Time t, const StateRef& out) noexcept {
  for (int attempt = 0; attempt < kTries; ++attempt) {
    const SampleStatus seen = see_newest(t);
    if (seen == SampleStatus::busy) continue;
    if (seen != SampleStatus::settled) return seen;
    const Found found = locate(t);
    if (found == Found::segment) return evaluate(kept_.current(), t, out);
    if (found == Found::before_first) {
      const bool holds = is_live(clock_) && summary_.first == 1;
      if (!holds) return SampleStatus::before_history;
      if (kept_.take(*board_, summary_, summary_.first)) return hold_first(out);
    }
  }
  return from_own_copy(t, out);
}

/// Makes the segment of `t` under summary_.revision the current copy.
Sampler::Found Sampler::locate(Time t) noexcept {
  const BoardSegment& last = kept_.current();
  if (kept_.is_confirmed(*board_, summary_)) {
    if (spans(last, t)) return Found::segment;
    if (t >= last.right() && last.next() <= summary_.newest) {
      if (!kept_.take(*board_, summary_, last.next())) return Found::torn;
      if (spans(kept_.current(), t)) return Found::segment;
    }
  }
  // Usually the current segment was republished: it or its successor contains t. Tags are already
  // prefetched.
  Word number = number_near(kept_.current(), t);
  if (number >= summary_.first && number <= summary_.newest) {
    if (!kept_.take(*board_, summary_, number)) return Found::torn;
    if (spans(kept_.current(), t)) return Found::segment;
  }
  number = number_by_hint(*board_, summary_, t);
  if (number != 0) {
    board_->prefetch_segment(number);
    if (!kept_.take(*board_, summary_, number)) return Found::torn;
    if (spans(kept_.current(), t)) return Found::segment;
  }
  // The hint failed because a writer is active: searches the knots themselves.
  if (!number_by_cells(*board_, summary_, t, number)) return Found::torn;
  if (number == 0) return Found::before_first;
  if (!kept_.take(*board_, summary_, number)) return Found::torn;
  return spans(kept_.current(), t) ? Found::segment : Found::torn;
}

/// Whether a segment contains a time. A time on a knot belongs to the segment on its right. All
/// times after the last segment belong to the last segment.
bool Sampler::spans(const BoardSegment& segment, Time t) const noexcept {
  return t >= segment.left() && (t < segment.right() || segment.is_last(summary_));
}

namespace {

SegmentView view_of(const BoardSegment& segment) noexcept {
  return {.left = segment.left(),
          .right = segment.right(),
          .order = segment.order(),
          .kind = segment.kind(),
          .coefficients = segment.coefficients()};
}

}  // namespace

SampleStatus Sampler::evaluate(const BoardSegment& segment, Time t,
                               const StateRef& out) const noexcept {
  const SegmentView view = view_of(segment);
  values_at(view, kinds_, t, fraction_, out);
  if (summary_.finished && t <= view.right) return SampleStatus::settled;
  if (rests_at(view, t)) return SampleStatus::holding;
  if (segment.kind() == SegmentKind::stop) return SampleStatus::stopping;
  return t < summary_.settled_until ? SampleStatus::settled : SampleStatus::provisional;
}

/// Before the first waypoint of a live stream the machine is held at its start position, unless it
/// starts in motion.
SampleStatus Sampler::hold_first(const StateRef& out) noexcept {
  if (!values_before(view_of(kept_.current()), kinds_, out)) return SampleStatus::no_data;
  return SampleStatus::holding;
}

/// The sample after the writer has overtaken every try: from the reader's own copy, which can no
/// longer change before the settled_until that was copied with it. Not on a stream that follows a
/// law: while that holds, settled_until may go back.
SampleStatus Sampler::from_own_copy(Time t, const StateRef& out) noexcept {
  const BoardSegment& own = kept_.current();
  if (clock_ == StreamClock::law || !own.is_there() || t < own.left() || t >= own.right() ||
      t >= kept_.settled_until()) {
    return SampleStatus::busy;
  }
  values_at(view_of(own), kinds_, t, fraction_, out);
  return SampleStatus::settled;
}

}  // namespace splinecast::ipc
