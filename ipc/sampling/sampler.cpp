#include "ipc/sampling/sampler.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "core/polynomial/segment.hpp"

namespace splinecast::ipc {
namespace {

/// How often a sample tries again when the writer overtakes it. A try takes well under a
/// microsecond and fails only if a whole revision was written within it.
constexpr int kTries = 16;

/// Seconds from a segment's left end; whatever the region holds, without signed overflow.
double seconds_after(Time left, Time t) noexcept {
  return to_seconds(to_time(to_word(t) - to_word(left)));
}

/// Copies the derivatives asked for, one behind the other.
void copy_asked(const State& state, Derivatives asked, std::span<double> out) noexcept {
  const std::array<std::pair<Derivatives, std::span<const double>>, 4> parts{
      {{Derivatives::position, state.position()},
       {Derivatives::velocity, state.velocity()},
       {Derivatives::acceleration, state.acceleration()},
       {Derivatives::jerk, state.jerk()}}};
  for (const auto& [derivative, values] : parts) {
    if (!contains(asked, derivative)) continue;
    std::ranges::copy(values, out.begin());
    out = out.subspan(values.size());
  }
}

/// Takes values from others, one by one.
void subtract(std::span<double> from, std::span<const double> values) noexcept {
  for (std::size_t d = 0; d < from.size(); ++d) from[d] -= values[d];
}

/// Sets velocity, acceleration and jerk to 0: at rest.
void come_to_rest(const StateRef& out) noexcept {
  std::ranges::fill(out.velocity, 0.0);
  std::ranges::fill(out.acceleration, 0.0);
  std::ranges::fill(out.jerk, 0.0);
}

}  // namespace

Sampler::Sampler(const KnotBoardReader& board, StreamClock clock, DimensionKinds kinds)
    : board_(&board),
      clock_(clock),
      kinds_(std::move(kinds)),
      all_linear_(kinds_.all_linear()),
      copies_(kSegmentsKept + 1, Kept{BoardSegment(board.dimensions(), board.smooths())}),
      current_(copies_.data()),
      state_(board.dimensions()),
      start_acceleration_(board.dimensions()),
      end_acceleration_(board.dimensions()) {
  std::iota(places_.begin(), places_.end(), std::uint8_t{0});
}

/// Whether each span has one value per dimension.
inline bool Sampler::fits(const StateRef& out) const noexcept {
  const std::size_t wanted = board_->dimensions();
  return ((out.position.size() ^ wanted) | (out.velocity.size() ^ wanted) |
          (out.acceleration.size() ^ wanted) | (out.jerk.size() ^ wanted)) == 0;
}

/// The sample at t. Mostly nothing has been published since the last one, and t lies in the segment
/// used last: then there is nothing to look up.
inline SampleStatus Sampler::find(Time t, const StateRef& out) noexcept {
  if (board_->retired()) return SampleStatus::retired;
  const Look look = board_->look();
  const bool is_at_hand = look.revision == confirmed_ && t >= at_hand_.left && t < at_hand_.right;
  if (!is_at_hand && (look.revision != confirmed_ || !goes_on(t))) return look_up(t, out);
  head_.settled_until = look.settled_until;
  copied_settled_until_ = look.settled_until;
  const BoardSegment& own = current();
  core::evaluate(own.order(), own.coefficients(), seconds_after(at_hand_.left, t), out);
  if (!all_linear_) kinds_.normalise(out);
  return at_hand_.is_finished || t < look.settled_until ? SampleStatus::settled
                                                        : SampleStatus::provisional;
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

/// Makes the next segment of the same revision the current one if t may lie there. Returns whether
/// t lies where it moves.
bool Sampler::goes_on(Time t) noexcept {
  if (confirmed_ != head_.revision || !current().is_there() || t < current().right()) return false;
  const Word next = current().next();
  if (next > head_.newest || !take(next)) return false;
  return t >= at_hand_.left && t < at_hand_.right;
}

/// Takes the bounds of a revision over, and whether it, or one before it that this reader has not
/// seen, changed the curve before a time that this reader has sampled.
bool Sampler::see(const Look& look) noexcept {
  const Head before = head_;
  if (!board_->copy_bounds(look, before.revision, head_)) return false;
  if (revised_ || before.revision == 0 || sampled_until_ < head_.changed_from) return true;
  if (head_.changed_from > Time::min()) {
    revised_ = true;
    return true;
  }
  // More revisions have been missed than the board keeps the changes of.
  if (sampled_until_ < before.settled_until) return true;
  const Compared compared = compare_with(before);
  if (compared == Compared::torn) {
    head_ = before;
    return false;
  }
  revised_ = compared == Compared::changed;
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
  BoardSegment& now = spare();
  for (int compared = 0; compared < kMostCompared; ++compared) {
    const BoardSegment::Taken taken = now.take(*board_, head_, number);
    if (taken == BoardSegment::Taken::torn) return Compared::torn;
    if (taken == BoardSegment::Taken::none) return Compared::changed;
    if (is_ahead(now, before)) return Compared::same;
    if (!is_unchanged(now, before)) return Compared::changed;
    if (sampled_until_ < now.right()) return Compared::same;
    const bool is_last = now.is_last(head_);
    if (number == before.newest) return is_last ? Compared::same : compare_rest(now);
    if (is_last) return Compared::changed;  // the stop has been dropped
    number = now.next();
  }
  return Compared::changed;
}

/// Whether the curve begins with a segment before which the machine is held in the same position as
/// under `before`, and nothing later has been sampled.
bool Sampler::is_ahead(const BoardSegment& first, const Head& before) noexcept {
  const BoardSegment& own = current();
  const bool is_known = confirmed_ == before.revision && own.is_there() && own.number() == 1;
  if (!is_known || first.number() != 1) return false;
  const auto position = own.coefficients().first(board_->dimensions());
  return sampled_until_ < std::min(first.left(), own.left()) &&
         std::ranges::equal(position, first.coefficients().first(position.size()));
}

/// Whether a segment is, as far as it has been sampled, what it was under `before`.
bool Sampler::is_unchanged(const BoardSegment& segment, const Head& before) noexcept {
  const BoardSegment& own = current();
  const bool is_known = confirmed_ == before.revision && own.is_there();
  if (segment.changed_by(is_known ? &own : nullptr) <= before.revision) return true;
  if (!is_known || own.number() != segment.number()) return false;
  const bool ends_alike =
      segment.right() == own.right() || sampled_until_ < std::min(segment.right(), own.right());
  const std::size_t values = static_cast<std::size_t>(own.order()) * board_->dimensions();
  return ends_alike && segment.left() == own.left() && segment.order() == own.order() &&
         segment.kind() == own.kind() &&
         std::ranges::equal(segment.coefficients().first(values), own.coefficients().first(values));
}

/// Whether the curve still rests behind `last`, which was the newest segment, until after the
/// latest time sampled. Copies the segment behind it in its place.
Sampler::Compared Sampler::compare_rest(BoardSegment& last) noexcept {
  const auto rest = state_.ref().position;
  const Time right = last.right();
  core::evaluate_derivative(last.order(), last.coefficients(), seconds_after(last.left(), right), 0,
                            rest);
  BoardSegment& next = last;
  const BoardSegment::Taken taken = next.take(*board_, head_, last.next());
  if (taken == BoardSegment::Taken::torn) return Compared::torn;
  const bool rests = taken == BoardSegment::Taken::whole && next.kind() == SegmentKind::hold &&
                     next.left() == right && sampled_until_ < next.right() &&
                     std::ranges::equal(next.coefficients().first(rest.size()), rest);
  return rests ? Compared::same : Compared::changed;
}

SampleStatus Sampler::preview(Time t, const StateRef& out) noexcept {
  return fits(out) ? find(t, out) : SampleStatus::wrong_dimension;
}

/// Makes head_ that of the newest revision; t is the time that will be looked up in it. Returns
/// `settled` if there is a curve, `busy` if the writer has gone on, else the reason for none.
SampleStatus Sampler::see_newest(Time t) noexcept {
  if (board_->retired()) return SampleStatus::retired;
  const Look look = board_->look();
  if (look.revision == 0) return SampleStatus::no_data;
  if (look.revision == head_.revision) {
    head_.settled_until = look.settled_until;
  } else {
    const Word likely = near(current(), t);
    board_->prefetch(look.revision, likely != 0 ? likely : current().number());
    if (!see(look)) return SampleStatus::busy;
  }
  return head_.newest == 0 ? SampleStatus::no_data : SampleStatus::settled;
}

SampleStatus Sampler::look_up(Time t, const StateRef& out) noexcept {
  for (int attempt = 0; attempt < kTries; ++attempt) {
    const SampleStatus seen = see_newest(t);
    if (seen == SampleStatus::busy) continue;
    if (seen != SampleStatus::settled) return seen;
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

/// The segment of t if it is the copied one or, by its length, the next; else 0.
Word Sampler::near(const BoardSegment& copy, Time t) noexcept {
  if (!copy.is_there() || t < copy.left()) return 0;
  if (t < copy.right()) return copy.number();
  const Word length = to_word(copy.right()) - to_word(copy.left());
  return to_word(t) - to_word(copy.right()) < length ? copy.next() : 0;
}

/// Makes current() the segment of `t` under head_.revision.
Sampler::Found Sampler::locate(Time t) noexcept {
  const BoardSegment& last = current();
  if (is_confirmed()) {
    if (spans(last, t)) return Found::segment;
    if (t >= last.right() && last.next() <= head_.newest) {
      if (!take(last.next())) return Found::torn;
      if (spans(current(), t)) return Found::segment;
    }
  }
  // Mostly it has been written again, and it or the next one spans t: their tags are on their way.
  Word number = near(current(), t);
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
  // The hint failed: a writer is at work. The knots decide.
  if (!number_by_cells(t, number)) return Found::torn;
  if (number == 0) return Found::before_first;
  if (!take(number)) return Found::torn;
  return spans(current(), t) ? Found::segment : Found::torn;
}

/// Whether the current copy is what the head's revision holds, without copying it again.
bool Sampler::is_confirmed() noexcept {
  if (confirmed_ == head_.revision) return true;
  const bool stands = current().is_current(*board_, head_);
  if (stands) confirm();
  return stands;
}

/// Makes a copy that the head's revision holds the current one.
void Sampler::confirm(Kept& copy) noexcept {
  current_ = &copy;
  confirm();
}

void Sampler::confirm() noexcept {
  current_->known_by = head_.revision;
  confirmed_ = head_.revision;
  copied_settled_until_ = head_.settled_until;
  const BoardSegment& own = current();
  const bool moves = own.kind() == SegmentKind::spline || own.kind() == SegmentKind::splice;
  at_hand_ = {
      .left = own.left(), .right = moves ? own.right() : own.left(), .is_finished = head_.finished};
}

/// Makes the segment that begins at knot `number`, or at the one before if none begins there, the
/// current copy; keeps the one before if that fails.
bool Sampler::take(Word number) noexcept {
  Kept& kept = copies_[place_of(number)];
  const bool is_kept = kept.segment.is_there() && kept.segment.number() == number;
  if (is_kept && (kept.known_by == head_.revision || kept.segment.is_current(*board_, head_))) {
    confirm(kept);
    return true;
  }
  BoardSegment& copy = spare();
  BoardSegment::Taken taken = copy.take(*board_, head_, number, &current());
  if (taken == BoardSegment::Taken::none && number > head_.first) {
    taken = copy.take(*board_, head_, number - 1, &current());
  }
  if (taken != BoardSegment::Taken::whole) return false;
  std::uint8_t& place = place_of(copy.number());
  const std::size_t freed = place;
  place = static_cast<std::uint8_t>(spare_);
  confirm(copies_[spare_]);
  spare_ = freed;
  return true;
}

/// Whether a time belongs to a segment: a time on a knot to the one on its right; all times behind
/// the last segment to that one.
bool Sampler::spans(const BoardSegment& segment, Time t) const noexcept {
  return t >= segment.left() && (t < segment.right() || segment.is_last(head_));
}

/// Where a time would lie if the knots came at an even pace: a segment of the head.
Word Sampler::guess_by_pace(Time t) const noexcept {
  const Time oldest = board_->time_hint(head_.first);
  const double share =
      seconds_after(oldest, t) / seconds_after(oldest, board_->time_hint(head_.newest));
  const auto intervals = static_cast<double>(head_.newest - head_.first);
  // Written so that what is no number, or not on the board, becomes an end of it.
  if (!(share > 0)) return head_.first;
  return share < 1 ? head_.first + static_cast<Word>(share * intervals) : head_.newest;
}

/// The last knot at or before whose time a segment begins, by the packed times; 0 if t is before
/// all. From the guess in steps that double, then by halves: a look or two at an even pace, and
/// never more than 2 log n.
Word Sampler::number_by_hint(Time t) const noexcept {
  Word low = head_.first;
  Word high = head_.newest + 1;
  const auto is_behind = [&](Word number) { return board_->time_hint(number) > t; };
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

/// When the segment at knot `number` begins, or, where none does, the next one; at the end of a
/// finished curve, when that ends. Returns false if a knot was written meanwhile.
bool Sampler::begin_of(Word number, Time& begin, bool& is_end) const noexcept {
  core::SegmentForm form{};
  if (!board_->copy_time(number, head_.revision, begin, form)) return false;
  is_end = form == core::SegmentForm::none;
  if (!is_end || number == head_.newest) return true;
  return board_->copy_time(number + 1, head_.revision, begin, form);
}

/// The same by the knots, under the revision of the head. Returns false if one was written
/// meanwhile.
bool Sampler::number_by_cells(Time t, Word& number) const noexcept {
  Word low = head_.first;
  Word high = head_.newest + 1;
  bool is_end = false;
  while (low < high) {
    const Word middle = low + (high - low) / 2;
    Time begin{};
    if (!begin_of(middle, begin, is_end)) return false;
    if (begin <= t) {
      low = middle + 1;
    } else {
      high = middle;
    }
  }
  number = low == head_.first ? 0 : low - 1;
  if (number > head_.first && number == head_.newest) {
    Time begin{};
    if (!begin_of(number, begin, is_end)) return false;
    if (is_end) --number;
  }
  return true;
}

/// Evaluates a segment u seconds after its left end, in the form in which dimensions are read.
void Sampler::read(const BoardSegment& segment, double u, const StateRef& out) const noexcept {
  core::evaluate(segment.order(), segment.coefficients(), u, out);
  if (!all_linear_) kinds_.normalise(out);
}

SampleStatus Sampler::evaluate(const BoardSegment& segment, Time t,
                               const StateRef& out) const noexcept {
  const Time right = segment.right();
  const bool past_end = t > right || segment.kind() == SegmentKind::hold ||
                        (t == right && segment.kind() == SegmentKind::stop_tail);
  const Time at = past_end ? right : t;
  read(segment, seconds_after(segment.left(), at), out);
  if (past_end) come_to_rest(out);
  if (head_.finished && t <= right) return SampleStatus::settled;
  if (past_end) return SampleStatus::holding;
  if (segment.kind() == SegmentKind::stop_tail) return SampleStatus::stopping;
  return t < head_.settled_until ? SampleStatus::settled : SampleStatus::provisional;
}

/// Before the first waypoint of a live stream the machine stands where it will start, unless it
/// starts in motion.
SampleStatus Sampler::hold_first(const StateRef& out) noexcept {
  const std::size_t dimensions = board_->dimensions();
  const auto velocity = current().coefficients().subspan(dimensions, dimensions);
  if (std::ranges::any_of(velocity, [](double v) { return v != 0; })) return SampleStatus::no_data;
  // Not evaluated: other coefficients, which may still change, would decide on the sign of a 0.
  std::ranges::copy(current().coefficients().first(dimensions), out.position.begin());
  come_to_rest(out);
  if (!all_linear_) kinds_.normalise(out);
  return SampleStatus::holding;
}

/// What a reader may still say when the writer has overtaken every try: a time inside its own copy
/// and before the settled_until copied with it can no longer change.
SampleStatus Sampler::from_own_copy(Time t, const StateRef& out) noexcept {
  const BoardSegment& own = current();
  if (!own.is_there() || t < own.left() || t >= own.right() || t >= copied_settled_until_) {
    return SampleStatus::busy;
  }
  read(own, seconds_after(own.left(), t), out);
  return SampleStatus::settled;
}

Word Sampler::sample_many(std::span<const Time> times, const SampleBlock& out) noexcept {
  const std::size_t values = count(out.derivatives) * board_->dimensions();
  const bool fits = out.status.size() == times.size() && out.values.size() == times.size() * values;
  SampleStatus seen = fits ? SampleStatus::busy : SampleStatus::wrong_dimension;
  for (int attempt = 0; attempt < kTries && seen == SampleStatus::busy; ++attempt) {
    seen = see_newest(times.empty() ? Time{} : times.front());
    if (seen != SampleStatus::settled) continue;
    if (evaluate_many(times, out)) return head_.revision;
    seen = SampleStatus::busy;
  }
  std::ranges::fill(out.status, seen);
  return 0;
}

/// Evaluates all times under head_.revision. Returns false if the writer has gone on meanwhile.
bool Sampler::evaluate_many(std::span<const Time> times, const SampleBlock& out) noexcept {
  const std::size_t dimensions = board_->dimensions();
  const std::size_t stride = count(out.derivatives) * dimensions;
  for (std::size_t i = 0; i < times.size();) {
    const Found found = goes_on(times[i]) ? Found::segment : locate(times[i]);
    if (found == Found::torn) return false;
    if (found == Found::segment) {
      const std::size_t evaluated = evaluate_moving(times, i, stride, out);
      i += evaluated;
      if (evaluated > 0) continue;
      out.status[i] = evaluate(current(), times[i], state_.ref());
    } else if (clock_ != StreamClock::monotonic || head_.first != 1) {
      out.status[i] = SampleStatus::before_history;
    } else if (take(head_.first)) {
      out.status[i] = hold_first(state_.ref());
    } else {
      return false;
    }
    if (has_values(out.status[i])) {
      copy_asked(state_, out.derivatives, out.values.subspan(i * stride, stride));
    }
    ++i;
  }
  return true;
}

/// Evaluates as many of the times from `first` on as lie on the current copy, where it moves and
/// needs no more than its polynomial. Returns how many.
std::size_t Sampler::evaluate_moving(std::span<const Time> times, std::size_t first,
                                     std::size_t stride, const SampleBlock& out) noexcept {
  if (!all_linear_) return 0;
  const BoardSegment& own = current();
  const Time settled_until = at_hand_.is_finished ? Time::max() : head_.settled_until;
  // Not cleared first: that would take as long as the lookup.
  std::array<double, 16> u;  // NOLINT(*-member-init)
  std::size_t n = 0;
  while (n < u.size() && first + n < times.size()) {
    const Time t = times[first + n];
    if (t < at_hand_.left || t >= at_hand_.right) break;
    u[n] = seconds_after(at_hand_.left, t);
    out.status[first + n] = t < settled_until ? SampleStatus::settled : SampleStatus::provisional;
    ++n;
  }
  core::evaluate_many(own.order(), own.coefficients(), board_->dimensions(), std::span(u).first(n),
                      out.derivatives, out.values.subspan(first * stride, n * stride), stride);
  return n;
}

/// Copies the segments from one to another under head_.revision, with their acceleration steps.
bool Sampler::copy_segments(Word oldest, Word newest, BoardSnapshot& out) {
  BoardSegment& copy = spare();
  std::size_t count = 0;
  // The newest first: they are the ones that the writer will overwrite first.
  for (Word number = newest;;) {
    if (copy.take(*board_, head_, number) != BoardSegment::Taken::whole) return false;
    if (out.segments_.size() == count) out.segments_.emplace_back();
    SegmentCopy& segment = out.segments_[count];
    copy.copy_to(segment);
    segment.acceleration_step.resize(board_->dimensions());
    copy.write_accelerations(segment.acceleration_step, end_acceleration_);
    if (count > 0) subtract(out.segments_[count - 1].acceleration_step, end_acceleration_);
    ++count;
    if (number == oldest) break;
    const auto before = segment_before(*board_, head_, number);
    if (!before || *before < oldest) return false;
    number = *before;
  }
  if (!finish_oldest_step(out.segments_[count - 1])) return false;
  for (SegmentCopy& segment : std::span(out.segments_).first(count)) {
    if (segment.acceleration_step.empty()) continue;
    kinds_.normalise_step(std::span(segment.coefficients).first(board_->dimensions()),
                          segment.acceleration_step);
  }
  std::reverse(out.segments_.begin(), out.segments_.begin() + static_cast<std::ptrdiff_t>(count));
  out.size_ = count;
  return true;
}

/// Makes the acceleration at the left end of a snapshot's oldest segment the step there.
bool Sampler::finish_oldest_step(SegmentCopy& oldest) {
  if (oldest.number == 1) {
    const bool is_held = clock_ == StreamClock::monotonic && oldest.has_waypoint;
    if (!is_held) std::ranges::fill(oldest.acceleration_step, 0.0);  // nothing stands before it
    return true;
  }
  const auto before = segment_before(*board_, head_, oldest.number);
  if (!before) return false;
  if (*before == 0) {
    oldest.acceleration_step.clear();
    return true;
  }
  BoardSegment& copy = spare();
  if (copy.take(*board_, head_, *before) != BoardSegment::Taken::whole) return false;
  copy.write_accelerations(start_acceleration_, end_acceleration_);
  subtract(oldest.acceleration_step, end_acceleration_);
  return true;
}

SampleStatus Sampler::snapshot(Time from, Time to, BoardSnapshot& out) {
  out.size_ = 0;
  if (out.dimensions() != board_->dimensions()) return SampleStatus::wrong_dimension;
  for (int attempt = 0; attempt < kTries; ++attempt) {
    if (board_->retired()) return SampleStatus::retired;
    const Look look = board_->look();
    if (look.revision == 0) return SampleStatus::no_data;
    head_.settled_until =
        look.revision == head_.revision ? look.settled_until : head_.settled_until;
    if ((look.revision != head_.revision && !see(look)) || !board_->copy_head(look, out.head_)) {
      continue;
    }
    if (head_.newest == 0) return SampleStatus::no_data;
    Word oldest = 0;
    Word newest = 0;
    if (!number_by_cells(from, oldest) || !number_by_cells(to, newest)) continue;
    if (oldest == 0) return SampleStatus::before_history;
    if (newest >= oldest && !copy_segments(oldest, newest, out)) continue;
    return head_.finished || to < head_.settled_until ? SampleStatus::settled
                                                      : SampleStatus::provisional;
  }
  return SampleStatus::busy;
}

}  // namespace splinecast::ipc
