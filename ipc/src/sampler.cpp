#include "splinecast/ipc/sampler.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "splinecast/core/segment.hpp"

namespace splinecast::ipc {
namespace {

/// How often a sample tries again when the writer overtakes it. A try takes well under a
/// microsecond and fails only if a whole revision was written within it.
constexpr int kTries = 16;

/// Seconds from a segment's left end; whatever the region holds, without signed overflow.
double seconds_after(core::Time left, core::Time t) noexcept {
  return core::to_seconds(to_time(to_word(t) - to_word(left)));
}

/// Sets velocity, acceleration and jerk to 0: at rest.
void come_to_rest(const core::StateRef& out) noexcept {
  std::ranges::fill(out.velocity, 0.0);
  std::ranges::fill(out.acceleration, 0.0);
  std::ranges::fill(out.jerk, 0.0);
}

}  // namespace

Sampler::Sampler(const SegmentBoardReader& board, StreamClock clock, core::DimensionKinds kinds)
    : board_(&board),
      clock_(clock),
      kinds_(std::move(kinds)),
      all_linear_(kinds_.all_linear()),
      copies_{SegmentCopy(board.dimensions()), SegmentCopy(board.dimensions())} {}

/// Whether each span has one value per dimension.
inline bool Sampler::fits(const core::StateRef& out) const noexcept {
  const std::size_t wanted = board_->dimensions();
  return ((out.position.size() ^ wanted) | (out.velocity.size() ^ wanted) |
          (out.acceleration.size() ^ wanted) | (out.jerk.size() ^ wanted)) == 0;
}

/// The sample at t. Mostly nothing has been published since the last one, and t lies in the segment
/// used last: then there is nothing to look up.
inline SampleStatus Sampler::find(core::Time t, const core::StateRef& out) noexcept {
  if (!fits(out)) return SampleStatus::wrong_dimension;
  if (board_->retired()) return SampleStatus::retired;
  const bool is_at_hand =
      board_->revision() == confirmed_ && t >= at_hand_.left && t < at_hand_.right;
  if (!is_at_hand) return look_up(t, out);
  const SegmentCopy& own = current();
  core::evaluate(own.order, own.coefficients, seconds_after(at_hand_.left, t), out);
  if (!all_linear_) kinds_.normalise(out);
  return t < at_hand_.settled_until ? SampleStatus::settled : SampleStatus::provisional;
}

SampleStatus Sampler::sample(core::Time t, const core::StateRef& out) noexcept {
  const SampleStatus status = find(t, out);
  if (clock_ == StreamClock::recorded || !has_values(status)) return status;
  const bool is_revised = revised_;
  sampled_until_ = is_revised ? t : std::max(sampled_until_, t);
  revised_ = false;
  return is_revised ? SampleStatus::revised : status;
}

/// Takes the bounds of a revision over, and whether it, or one before it that this reader has not
/// seen, changed the curve before a time that this reader has sampled.
bool Sampler::see(Word r) noexcept {
  const Word seen = seen_;
  if (seen > 0 && r - seen > kHeadChangesKept) return see_after_gap(r);
  if (!board_->copy_bounds(r, seen, head_)) return false;
  seen_ = r;
  revised_ = revised_ || (seen > 0 && sampled_until_ >= head_.changed_from);
  return true;
}

/// The same where more revisions have been missed than the board keeps the changes of.
bool Sampler::see_after_gap(Word r) noexcept {
  const Head before = head_;
  if (!board_->copy_bounds(r, seen_, head_)) return false;
  if (!revised_ && sampled_until_ >= before.settled_until) {
    const Compared compared = compare_with(before);
    if (compared == Compared::torn) {
      head_ = before;
      return false;
    }
    revised_ = compared == Compared::changed;
  }
  seen_ = r;
  return true;
}

/// Whether the curve under head_ is that under `before`, from what was settled then to the latest
/// time sampled.
Sampler::Compared Sampler::compare_with(const Head& before) noexcept {
  Word number = 0;
  if (head_.newest == 0) return Compared::changed;
  if (!number_by_cells(before.settled_until, number)) return Compared::torn;
  if (number == 0 && head_.first == 1) number = 1;  // the machine is held before it
  number = std::min(number, before.newest);
  if (number < head_.first) return Compared::changed;
  SegmentCopy& now = copies_[1 - current_];
  for (int compared = 0; compared < kMostCompared; ++compared, ++number) {
    if (!board_->copy_segment(number, head_.revision, now)) return Compared::torn;
    if (!is_unchanged(now, before)) return Compared::changed;
    if (sampled_until_ < now.right) return Compared::same;
    if (number == before.newest) {
      return number == head_.newest ? Compared::same : compare_rest(now);
    }
    if (number == head_.newest) return Compared::changed;  // the stop tail has been dropped
  }
  return Compared::changed;
}

/// Whether a segment is, as far as it has been sampled, what it was under `before`.
bool Sampler::is_unchanged(const SegmentCopy& segment, const Head& before) noexcept {
  if (segment.tag <= before.revision) return true;
  const SegmentCopy& own = current();
  if (confirmed_ != before.revision || own.tag == 0 || own.number != segment.number) return false;
  const bool ends_alike =
      segment.right == own.right || sampled_until_ < std::min(segment.right, own.right);
  const std::size_t values = static_cast<std::size_t>(own.order) * board_->dimensions();
  return ends_alike && segment.left == own.left && segment.order == own.order &&
         segment.kind == own.kind &&
         std::ranges::equal(std::span(segment.coefficients).first(values),
                            std::span(own.coefficients).first(values));
}

/// Whether the curve still rests behind `last`, which was the newest segment, until after the
/// latest time sampled. Copies the segment behind it in its place.
Sampler::Compared Sampler::compare_rest(SegmentCopy& last) noexcept {
  std::array<double, core::kMaxDimensions> values{};
  const auto rest = std::span(values).first(board_->dimensions());
  const core::Time right = last.right;
  core::evaluate_derivative(last.order, last.coefficients, seconds_after(last.left, right), 0,
                            rest);
  SegmentCopy& next = last;
  if (!board_->copy_segment(last.number + 1, head_.revision, next)) return Compared::torn;
  const bool rests = next.kind == core::SegmentKind::hold && next.left == right &&
                     sampled_until_ < next.right &&
                     std::ranges::equal(std::span(next.coefficients).first(rest.size()), rest);
  return rests ? Compared::same : Compared::changed;
}

SampleStatus Sampler::preview(core::Time t, const core::StateRef& out) noexcept {
  return find(t, out);
}

SampleStatus Sampler::look_up(core::Time t, const core::StateRef& out) noexcept {
  for (int attempt = 0; attempt < kTries; ++attempt) {
    if (board_->retired()) return SampleStatus::retired;
    const Word r = board_->revision();
    if (r == 0) return SampleStatus::no_data;
    if (r != head_.revision) {
      board_->prefetch(r, current().number);
      if (!see(r)) continue;
    }
    if (head_.newest == 0) return SampleStatus::no_data;
    const Found found = locate(t);
    if (found == Found::segment) return evaluate(current(), t, out);
    if (found == Found::before_first) {
      const bool holds = clock_ == StreamClock::monotonic && head_.first == 1;
      if (!holds) return SampleStatus::before_history;
      if (take(head_.first)) return hold_first(out);
    }
  }
  return from_own_copy(t, out);
}

/// The segment of t if it is a copied one or, by its length, the next; else 0.
Word Sampler::near(const SegmentCopy& copy, core::Time t) noexcept {
  if (copy.tag == 0 || t < copy.left) return 0;
  if (t < copy.right) return copy.number;
  const Word length = to_word(copy.right) - to_word(copy.left);
  return to_word(t) - to_word(copy.right) < length ? copy.number + 1 : 0;
}

/// Makes current() the segment of `t` under head_.revision.
Sampler::Found Sampler::locate(core::Time t) noexcept {
  const Word r = head_.revision;
  const SegmentCopy& last = current();
  if (is_confirmed(r)) {
    if (spans(last, t)) return Found::segment;
    const Word next = last.number + 1;
    if (t >= last.right && next <= head_.newest) {
      if (!take(next)) return Found::torn;
      if (spans(current(), t)) return Found::segment;
    }
  }
  // Mostly it has been written again, and it or the next one spans t: their tags are on their way.
  Word number = near(last, t);
  if (number >= head_.first && number <= head_.newest) {
    if (!take(number)) return Found::torn;
    if (spans(current(), t)) return Found::segment;
  }
  number = number_by_hint(t);
  if (number != 0) {
    board_->prefetch_segment(number);
    if (!take(number)) return Found::torn;
    if (spans(current(), t)) return Found::segment;
  }
  // The hint failed: a writer died between, or is at work. The cells decide.
  if (!number_by_cells(t, number)) return Found::torn;
  if (number == 0) return Found::before_first;
  if (!take(number)) return Found::torn;
  return spans(current(), t) ? Found::segment : Found::torn;
}

/// Whether the current copy is what revision r holds, without copying it again.
bool Sampler::is_confirmed(Word r) noexcept {
  if (confirmed_ == r) return true;
  const SegmentCopy& last = current();
  const bool stands = last.tag != 0 && last.number >= head_.first && last.number <= head_.newest &&
                      board_->is_current(last, r);
  if (stands) confirm();
  return stands;
}

void Sampler::confirm() noexcept {
  confirmed_ = head_.revision;
  copied_settled_until_ = head_.settled_until;
  const SegmentCopy& own = current();
  const bool moves = own.kind == core::SegmentKind::spline || own.kind == core::SegmentKind::splice;
  at_hand_ = {.left = own.left,
              .right = moves ? own.right : own.left,
              .settled_until = head_.finished ? core::Time::max() : head_.settled_until};
}

/// Makes segment `number` the current copy; keeps the one before if that fails.
bool Sampler::take(Word number) noexcept {
  if (!board_->copy_segment(number, head_.revision, copies_[1 - current_])) return false;
  current_ = 1 - current_;
  confirm();
  return true;
}

/// Whether a time belongs to a segment: a time on a knot to the one on its right; all times behind
/// the newest segment to that one.
bool Sampler::spans(const SegmentCopy& segment, core::Time t) const noexcept {
  return t >= segment.left && (t < segment.right || segment.number == head_.newest);
}

/// Where a time would lie if the knots came at an even pace: a segment of the head.
Word Sampler::guess_by_pace(core::Time t) const noexcept {
  const core::Time oldest = board_->left_hint(head_.first);
  const double share =
      seconds_after(oldest, t) / seconds_after(oldest, board_->left_hint(head_.newest));
  const auto intervals = static_cast<double>(head_.newest - head_.first);
  // Written so that what is no number, or not on the board, becomes an end of it.
  if (!(share > 0)) return head_.first;
  return share < 1 ? head_.first + static_cast<Word>(share * intervals) : head_.newest;
}

/// The last segment whose left end is at or before t, by the packed times; 0 if t is before all.
/// From the guess in steps that double, then by halves: a look or two at an even pace, and never
/// more than 2 log n.
Word Sampler::number_by_hint(core::Time t) const noexcept {
  Word low = head_.first;
  Word high = head_.newest + 1;
  const auto is_behind = [&](Word number) { return board_->left_hint(number) > t; };
  const Word guess = guess_by_pace(t);
  if (is_behind(guess)) {
    high = guess;
    for (Word step = 1; step <= high - low; step *= 2) {
      if (!is_behind(high - step)) {
        low = high - step + 1;
        break;
      }
      high -= step;
    }
  } else {
    low = guess + 1;
    for (Word step = 1; step <= high - low; step *= 2) {
      if (is_behind(low + step - 1)) {
        high = low + step - 1;
        break;
      }
      low += step;
    }
  }
  while (low < high) {
    const Word middle = low + (high - low) / 2;
    if (is_behind(middle)) {
      high = middle;
    } else {
      low = middle + 1;
    }
  }
  return low == head_.first ? 0 : low - 1;
}

/// The same by the cells, under the revision of the head. Returns false if a cell was written
/// meanwhile.
bool Sampler::number_by_cells(core::Time t, Word& number) const noexcept {
  Word low = head_.first;
  Word high = head_.newest + 1;
  while (low < high) {
    const Word middle = low + (high - low) / 2;
    core::Time left{};
    if (!board_->copy_left(middle, head_.revision, left)) return false;
    if (left <= t) {
      low = middle + 1;
    } else {
      high = middle;
    }
  }
  number = low == head_.first ? 0 : low - 1;
  return true;
}

/// Evaluates a segment u seconds after its left end, in the form in which dimensions are read.
void Sampler::read(const SegmentCopy& segment, double u, const core::StateRef& out) const noexcept {
  core::evaluate(segment.order, segment.coefficients, u, out);
  if (!kinds_.all_linear()) kinds_.normalise(out);
}

SampleStatus Sampler::evaluate(const SegmentCopy& segment, core::Time t,
                               const core::StateRef& out) const noexcept {
  const bool past_end = t > segment.right || segment.kind == core::SegmentKind::hold ||
                        (t == segment.right && segment.kind == core::SegmentKind::stop_tail);
  const core::Time at = past_end ? segment.right : t;
  read(segment, seconds_after(segment.left, at), out);
  if (past_end) come_to_rest(out);
  if (head_.finished && t <= segment.right) return SampleStatus::settled;
  if (past_end) return SampleStatus::holding;
  if (segment.kind == core::SegmentKind::stop_tail) return SampleStatus::stopping;
  return t < head_.settled_until ? SampleStatus::settled : SampleStatus::provisional;
}

/// Before the first waypoint of a live stream the machine stands where it will start, unless it
/// starts in motion.
SampleStatus Sampler::hold_first(const core::StateRef& out) noexcept {
  const SegmentCopy& first = current();
  const auto velocity =
      std::span(first.coefficients).subspan(out.velocity.size()).first(out.velocity.size());
  if (std::ranges::any_of(velocity, [](double v) { return v != 0; })) return SampleStatus::no_data;
  // Not evaluated: other coefficients, which may still change, would decide on the sign of a 0.
  std::ranges::copy(std::span(first.coefficients).first(out.position.size()), out.position.begin());
  come_to_rest(out);
  if (!kinds_.all_linear()) kinds_.normalise(out);
  return SampleStatus::holding;
}

/// What a reader may still say when the writer has overtaken every try: a time inside its own copy
/// and before the settled_until copied with it can no longer change.
SampleStatus Sampler::from_own_copy(core::Time t, const core::StateRef& out) noexcept {
  const SegmentCopy& own = current();
  if (own.tag == 0 || t < own.left || t >= own.right || t >= copied_settled_until_) {
    return SampleStatus::busy;
  }
  read(own, seconds_after(own.left, t), out);
  return SampleStatus::settled;
}

bool Sampler::copy_whole(Word number, Word r, SegmentCopy& out) const {
  if (!board_->copy_segment(number, r, out)) return false;
  out.acceleration_step.resize(board_->dimensions());
  board_->copy_step(out, out.acceleration_step);
  kinds_.normalise_step(std::span(out.coefficients).first(board_->dimensions()),
                        out.acceleration_step);
  return board_->is_current(out, r) && std::ranges::all_of(out.acceleration_step, [](double step) {
           return std::isfinite(step);
         });
}

SampleStatus Sampler::snapshot(core::Time from, core::Time to, Snapshot& out) {
  out.size_ = 0;
  if (out.dimensions() != board_->dimensions()) return SampleStatus::wrong_dimension;
  for (int attempt = 0; attempt < kTries; ++attempt) {
    if (board_->retired()) return SampleStatus::retired;
    const Word r = board_->revision();
    if (r == 0) return SampleStatus::no_data;
    if ((r != head_.revision && !see(r)) || !board_->copy_head(r, out.head_)) continue;
    if (head_.newest == 0) return SampleStatus::no_data;
    Word oldest = 0;
    Word newest = 0;
    if (!number_by_cells(from, oldest) || !number_by_cells(to, newest)) continue;
    if (oldest == 0) return SampleStatus::before_history;
    const std::size_t count = newest >= oldest ? newest - oldest + 1 : 0;
    while (out.segments_.size() < count) out.segments_.emplace_back(board_->dimensions());
    // The newest first: it is the one that the writer will overwrite first.
    std::size_t left = count;
    while (left > 0 && copy_whole(oldest + left - 1, r, out.segments_[left - 1])) --left;
    if (left > 0) continue;
    out.size_ = count;
    return head_.finished || to < head_.settled_until ? SampleStatus::settled
                                                      : SampleStatus::provisional;
  }
  return SampleStatus::busy;
}

}  // namespace splinecast::ipc
