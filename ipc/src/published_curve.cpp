#include "splinecast/ipc/published_curve.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "splinecast/ipc/waypoint_ring.hpp"

namespace splinecast::ipc {
namespace {

/// Whether a knot that was read back can be gone on from.
bool is_sound(const core::Knot& knot) noexcept {
  const core::Prefix& prefix = knot.prefix;
  const auto are_numbers = [](std::span<const double> values) {
    return std::ranges::all_of(values, [](double value) { return std::isfinite(value); });
  };
  return is_time_in_range(knot.time) &&
         are_numbers(std::array{prefix.gamma, prefix.smoothing.pivot, prefix.smoothing.lower1,
                                prefix.smoothing.lower2}) &&
         are_numbers(knot.waypoint) && are_numbers(knot.g) && are_numbers(knot.position) &&
         are_numbers(knot.velocity) && are_numbers(knot.acceleration) && are_numbers(knot.residual);
}

}  // namespace

PublishedCurve::PublishedCurve(SegmentBoardWriter& board, const SegmentBoardReader& published,
                               const core::WindowOptions& options, core::DimensionKinds kinds)
    : board_(&board),
      published_(&published),
      window_(published.dimensions(), options),
      kinds_(std::move(kinds)),
      segment_(published.dimensions()),
      copy_(published.dimensions()),
      state_(published.dimensions()),
      knot_values_(SegmentBoardReader::kKnotValues * published.dimensions() *
                   (window_.knots_to_restore() + 1)),
      standing_values_(SegmentBoardReader::kKnotValues * published.dimensions() * standing_.size()),
      entry_step_(published.dimensions()) {
  knots_.reserve(window_.knots_to_restore());
}

core::Time PublishedCurve::newest_time() const noexcept {
  if (window_.knots() > 0) return window_.knot(window_.knots() - 1).time;
  return window_.entry().time();
}

core::Time PublishedCurve::settled_until() const noexcept {
  const std::size_t knots = window_.knots();
  if (knots == 0) return window_.entry().time();
  const std::size_t open = window_.settled_segments();
  if (window_.is_entered() && open == 0) return window_.entry().time();
  const std::size_t first = window_.is_entered() ? open - 1 : open;
  return window_.knot(std::min(first, knots - 1)).time;
}

std::span<const double> PublishedCurve::newest_position() const noexcept {
  if (window_.knots() > 0) return window_.knot(window_.knots() - 1).waypoint;
  return window_.is_entered() ? window_.entry().state().position : std::span<const double>{};
}

void PublishedCurve::freeze(core::Time t) noexcept {
  window_.freeze(t);
  // All segments have been committed as they are: those between frozen knots for good.
  settled_written_ = std::max(settled_written_, window_.settled_segments());
}

bool PublishedCurve::has_room(std::size_t segments, core::Time keep) const noexcept {
  return has_room_behind(has_changes_ ? number_of(window_.segments()) : newest_, segments, keep);
}

bool PublishedCurve::has_room_to_enter(core::Time t, std::size_t segments,
                                       core::Time keep) const noexcept {
  return has_room_behind(segment_at(t), segments, keep);
}

bool PublishedCurve::has_room_behind(Word number, std::size_t segments,
                                     core::Time keep) const noexcept {
  if (keep == core::Time::max()) return true;  // a recorded stream keeps nothing
  const Word newest = number + segments;
  if (newest <= board_->capacity() || newest - board_->capacity() < first_) return true;
  core::Time left{};
  core::Time right{};
  const bool is_there =
      published_->copy_ends(newest - board_->capacity(), board_->revision(), left, right);
  return !is_there || right <= keep;
}

core::Time PublishedCurve::earliest_entry() const noexcept {
  core::Time left{};
  if (newest_ == 0 || !published_->copy_left(first_, board_->revision(), left)) {
    return core::Time::max();
  }
  const bool is_held = first_ == 1 && !window_.is_entered() && window_.options().held_before_start;
  return is_held ? core::Time::min() : left;
}

/// The last committed segment whose left end is at or before t; else the first one.
Word PublishedCurve::segment_at(core::Time t) const noexcept {
  Word low = first_;
  Word high = newest_;
  while (low < high) {
    const Word middle = high - (high - low) / 2;
    core::Time left{};
    const bool is_there = published_->copy_left(middle, board_->revision(), left);
    if (is_there && left <= t) {
      low = middle;
    } else {
      high = middle - 1;
    }
  }
  return low;
}

/// The last waypoints on the curve up to segment `number` and time t, oldest first.
std::span<const core::StandingWaypoint> PublishedCurve::standing_before(Word number, core::Time t,
                                                                        Word r) noexcept {
  const std::size_t size = SegmentBoardReader::kKnotValues * window_.dimensions();
  return find_standing(
      standing_, number, std::max<Word>(first_, 1), t, [&](Word candidate, std::size_t found) {
        if (candidate > newest_) return core::StandingWaypoint{t, {}};  // a hold, not committed
        const auto values = std::span(standing_values_).subspan(found * size, size);
        const core::Knot read = knot(candidate, r, values);
        return core::StandingWaypoint{read.time, read.waypoint};
      });
}

/// Reads a knot back; what is none leaves the curve damaged, and is read as a knot without values.
core::Knot PublishedCurve::knot(Word number, Word r, std::span<double> values) noexcept {
  core::Time left{};
  if (published_->copy_left(number, r, left)) {
    const core::Knot read = published_->knot(number, r, values);
    if (is_sound(read)) return read;
  }
  is_damaged_ = true;
  return {};
}

void PublishedCurve::note_change(core::Time from) noexcept {
  changed_from_ = std::min(changed_from_, from);
  has_changes_ = true;
}

void PublishedCurve::begin(const core::Instant& state) noexcept {
  std::ranges::fill(entry_step_, 0.0);
  window_.enter(state, {});
  note_change(state.time);
}

void PublishedCurve::enter(core::Time t) noexcept {
  const Word r = board_->revision();
  const Word cut = segment_at(t);
  if (!published_->copy_segment(cut, r, copy_)) {
    is_damaged_ = true;  // nobody else writes
    return;
  }
  const bool is_over = t >= copy_.right;
  const bool is_before = t < copy_.left;
  evaluate_at_cut(copy_, t, state_);
  std::ranges::fill(entry_step_, 0.0);
  run_ = cut + 1;
  note_change(t);
  if (is_before) {
    run_ = cut;
  } else if (t > copy_.right) {
    core::build_hold(copy_.right, t, state_.position(), segment_);
    std::ranges::fill(segment_.acceleration_step, 0.0);
    board_->write(run_++, segment_, {});
  } else if (is_over) {
    // It ends at t as it is.
  } else if (t > copy_.left) {
    board_->write_cut(cut, t);
  } else {
    run_ = cut;  // the run takes its place, and begins with the same step
    published_->copy_step(copy_, entry_step_);
  }
  const core::StateRef state = state_.ref();
  if (run_ > 1) {
    kinds_.normalise_quaternions(state.position, state.velocity, state.acceleration);
  } else {  // the first segment keeps its bits: readers are held there before it
    std::ranges::copy(std::span(copy_.coefficients).first(state.position.size()),
                      state.position.begin());
  }
  window_.enter({.time = t,
                 .position = state_.position(),
                 .velocity = state_.velocity(),
                 .acceleration = state_.acceleration()},
                standing_before(run_ - 1, t, r));
  settled_written_ = 0;
}

void PublishedCurve::prefetch() const noexcept {
  // Of long lags only the newest knots: more would push out of the caches what has just come.
  constexpr std::size_t kMostKnots = 16;
  const std::size_t knots = std::min(window_.options().settle + 3, kMostKnots);
  for (std::size_t k = 0; k < knots; ++k) {
    for (const auto memory : window_.memory(window_.knots() - k)) {
      prefetch_lines(memory.data(), memory.size());
    }
  }
  for (const auto* values : {&segment_.coefficients, &segment_.acceleration_step}) {
    prefetch_lines(values->data(), values->size() * sizeof(double));
  }
  const std::size_t open = window_.segments() - std::min(window_.segments(), settled_written_);
  for (std::size_t i = 0; i < std::min(open, kMostKnots); ++i) board_->prefetch_tags(newest_ - i);
}

void PublishedCurve::append(const core::Waypoint& waypoint, Word item) noexcept {
  if (window_.knots() == 0) run_item_ = item;
  window_.append(waypoint);
  has_changes_ = true;
  // What has settled leaves the window and is written once, with its last value.
  while (settled_written_ < window_.settled_segments()) write_segment(settled_written_++);
}

void PublishedCurve::finish(const core::Condition& end, core::Time earliest) noexcept {
  const std::size_t knots = window_.knots();
  if (window_.frozen_knots() < knots || (knots == 0 && !window_.is_entered())) {
    window_.finish(end);
  } else {
    // What stands of the run stays as it is.
    if (!has_changes_) settled_written_ = window_.segments();
    if (knots > 0) return_to(window_.knot(knots - 1), earliest);
  }
  has_changes_ = true;
}

/// Lets the stop tail run and goes back to the newest knot, behind the window's last segment.
void PublishedCurve::return_to(const core::Knot& knot, core::Time earliest) noexcept {
  const auto way = way_back(window_, knot, segment_, state_);
  if (!way) return;
  const core::Time start = std::max(way->rest, earliest);
  if (start > way->rest) {
    core::build_hold(way->rest, start, state_.position(), segment_);
    write_besides(segment_);
  }
  build_way_back(*way, start, state_.position(), knot.position, segment_);
  write_besides(segment_);
}

void PublishedCurve::write_segment(std::size_t i) noexcept {
  window_.segment(i, segment_);
  note_change(segment_.left);
  const auto left = window_.left_knot(i);
  const std::size_t right = left ? *left + 1 : 0;
  SegmentOrigin origin{};
  if (right < window_.knots()) origin.right_newer_knots = window_.newer_knots_seen(right);
  if (left) {
    board_->write(number_of(i), segment_, window_.knot(*left), origin);
    return;
  }
  if (right < window_.knots()) origin.item = run_item_;
  std::ranges::copy(entry_step_, segment_.acceleration_step.begin());
  core::Knot knot{};
  knot.g = window_.entry().acceleration();
  knot.newer_knots = window_.newer_knots_seen_by_entry();
  board_->write(number_of(i), segment_, knot, origin);
}

/// Writes a segment behind the newest one, which the window knows nothing of.
void PublishedCurve::write_besides(const core::Segment& segment) noexcept {
  newest_ = number_of(window_.segments()) + besides_++;
  std::ranges::fill(segment_.acceleration_step, 0.0);
  // A hold says what stood already.
  note_change(segment.kind == core::SegmentKind::hold ? segment.right : segment.left);
  board_->write(newest_, segment, {});
  end_ = segment.right;
}

void PublishedCurve::write(Head& head) noexcept {
  head.changed_from = changed_from_;
  changed_from_ = core::Time::max();
  if (!has_changes_) return;
  const std::size_t segments = window_.segments();
  if (segments == 0) return;
  if (besides_ == 0) {
    newest_ = number_of(segments - 1);
    if (settled_written_ == segments) window_.segment(segments - 1, segment_);
  }
  for (std::size_t i = settled_written_; i < segments; ++i) write_segment(i);
  if (besides_ == 0) end_ = segment_.right;
  head.changed_from = std::min(head.changed_from, changed_from_);
  changed_from_ = core::Time::max();
  // Never back: a finish drops the stop tail, but the slot that it took is not given back.
  first_ = std::max<Word>({first_, 1, newest_ - std::min<Word>(newest_, board_->capacity()) + 1});
  head.first = first_;
  head.newest = newest_;
  head.run = run_;
  head.run_knots = window_.knots();
  head.run_frozen = window_.frozen_knots();
  head.is_entered = window_.is_entered();
}

void PublishedCurve::discard(const Head& head) noexcept {
  board_->discard();
  restore(head);
}

void PublishedCurve::restore(const Head& head) noexcept {
  has_changes_ = false;
  changed_from_ = core::Time::max();
  besides_ = 0;
  run_ = head.run;
  first_ = head.first;
  newest_ = head.newest;
  core::Time left{};
  end_ = left;
  is_damaged_ = newest_ > 0 && !published_->copy_ends(newest_, board_->revision(), left, end_);
  if (!head.finished) restore_run(head);
  settled_written_ = window_.settled_segments();
}

namespace {

/// Whether the segments of a head's run, which goes on, are the newest ones.
bool describes_a_run(const Head& head) noexcept {
  const Word segments = head.run_knots + (head.is_entered ? 1 : 0);
  if (head.newest == 0) return segments == 0;
  return head.run >= 1 && head.run <= head.newest && segments == head.newest - head.run + 1 &&
         head.run_knots <= segments;
}

}  // namespace

void PublishedCurve::restore_run(const Head& head) noexcept {
  if (!describes_a_run(head)) {
    is_damaged_ = true;
    return;
  }
  const Word r = board_->revision();
  const std::size_t dimensions = window_.dimensions();
  const std::size_t size = SegmentBoardReader::kKnotValues * dimensions;
  const std::size_t count = std::min<std::size_t>(head.run_knots, window_.knots_to_restore());
  const std::size_t first = head.run_knots - count;
  knots_.clear();
  for (std::size_t k = 0; k < count; ++k) {
    const Word number = number_of(first + k + (head.is_entered ? 1 : 0));
    knots_.push_back(knot(number, r, std::span(knot_values_).subspan(size * k, size)));
    const bool is_later = k == 0 || knots_[k].time > knots_[k - 1].time;
    is_damaged_ = is_damaged_ || knots_[k].waypoint.empty() || !is_later;
  }
  if (is_damaged_) return;
  if (!head.is_entered) return window_.restore(first, knots_);
  core::SlidingWindow::Entry entry{};
  if (first == 0) {
    const core::Knot splice = knot(run_, r, std::span(knot_values_).subspan(size * count, size));
    const bool is_earlier = knots_.empty() || splice.time < knots_.front().time;
    is_damaged_ = is_damaged_ || !is_earlier;
    if (is_damaged_) return;
    entry = {.from = {.time = splice.time,
                      .position = splice.position,
                      .velocity = splice.velocity,
                      .acceleration = splice.acceleration},
             .before = standing_before(run_ - 1, splice.time, r),
             .acceleration = splice.g,
             .newer_knots = splice.newer_knots};
    if (published_->copy_segment(run_, r, copy_)) {
      published_->copy_step(copy_, entry_step_);
      run_item_ = copy_.origin.item.value_or(0);
    }
  }
  window_.restore_entered(entry, first, knots_);
}

}  // namespace splinecast::ipc
