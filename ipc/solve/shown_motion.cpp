#include "ipc/solve/shown_motion.hpp"

#include <algorithm>
#include <cmath>

#include "core/basics/quantile.hpp"
#include "ipc/board/reader.hpp"
#include "ipc/layout/knot_slots.hpp"
#include "ipc/layout/summary.hpp"
#include "ipc/solve/curve_cut.hpp"

namespace splinecast::ipc {

ShownMotion::ShownMotion(const KnotBoardReader& board)
    : dimensions_(board.dimensions()),
      times_(kMost),
      positions_(kMost * dimensions_),
      values_(kMost),
      numbers_(kMost),
      knot_(dimensions_, board.smooths()) {
  limits_.velocity.resize(dimensions_);
  limits_.acceleration.resize(dimensions_);
}

void ShownMotion::take(Time time, std::span<const double> position) noexcept {
  const std::size_t at = count_++ % kMost;
  first_ = std::max(first_, count_ - std::min(count_, kMost));
  times_[at] = time;
  next_ = (time / kStep + 1) * kStep;
  has_looked_ = false;
  std::ranges::copy(position, std::span(positions_).subspan(at * dimensions_).begin());
}

void ShownMotion::forget_all() noexcept {
  count_ = first_ = 0;
  next_ = Time::min();
  has_looked_ = false;
}

void ShownMotion::forget_after(Time t) noexcept {
  if (count_ == first_ || times_[place(0)] <= t) return;
  while (count_ > first_ && times_[place(0)] > t) --count_;
  has_looked_ = false;
  if (count_ == first_) return forget_all();
  next_ = (times_[place(0)] / kStep + 1) * kStep;
}

void ShownMotion::restore(const KnotBoardReader& board, const Summary& summary, Time end) noexcept {
  forget_all();
  if (summary.newest > 0) take_met(board, summary, end);
}

void ShownMotion::restore(const core::SlidingWindow& window, const KnotBoardReader& board,
                          const Summary& summary, Time end, std::size_t first) noexcept {
  restore(board, summary, end);
  if (window.knots() == 0) return;
  take_passed(board, summary, first, window.oldest_segment());
  for (std::size_t i = std::max(first, window.oldest_segment()); i < window.knots(); ++i) {
    const core::Knot knot = window.knot(i);
    note(knot.time, knot.waypoint);
  }
}

/// Takes the first knot at or after each multiple of kStep, searched backwards from `end` by the
/// packed times.
void ShownMotion::take_met(const KnotBoardReader& board, const Summary& summary,
                           Time end) noexcept {
  const Time newest = std::min(end, board.time_hint(summary.newest));
  if (!is_time_in_range(newest)) return;
  Time t = (newest / kStep + 1) * kStep;
  std::size_t found = 0;
  for (std::size_t i = 0; i < kMost; ++i, t -= kStep) {
    const Word before = segment_at(board, summary, t - Time(1));
    const bool is_first = before == summary.first && board.time_hint(before) >= t;
    const Word number = std::min(is_first ? before : before + 1, summary.newest);
    if (found == 0 || number != numbers_[found - 1]) numbers_[found++] = number;
    if (before == summary.first) break;
  }
  while (found > 0) {
    const bool is_there = board.copy_knot(numbers_[--found], summary.revision, knot_);
    const bool is_met = is_there && knot_.note.is_waypoint && knot_.time < end &&
                        knot_.note.form != core::SegmentForm::none;
    if (is_met) note(knot_.time, knot_.waypoint());
  }
}

void ShownMotion::take_passed(const KnotBoardReader& board, const Summary& summary,
                              std::size_t first, std::size_t end) noexcept {
  first = std::max(first, end - std::min(end, kPassedSlots));
  for (std::size_t i = first; i < end; ++i) {
    const bool is_there = board.copy_passed(i, summary.revision, knot_) && knot_.note.is_waypoint &&
                          knot_.item == (summary.run_item << kPassedItemShift | i);
    if (is_there) note(knot_.time, knot_.waypoint());
  }
}

/// The 95 % quantile of the first `count` values; 0 if there are none.
double ShownMotion::quantile(std::size_t count) noexcept {
  return core::quantile(std::span(values_).first(count), 0.95);
}

void ShownMotion::look(Time stop_time) noexcept {
  if (has_looked_) return;
  has_looked_ = true;
  std::size_t kept = count_ - first_;
  while (kept > 0 && times_[place(0)] - times_[place(kept - 1)] > kSpan) --kept;
  const std::size_t chords = kept - std::min<std::size_t>(kept, 1);
  const double stop = to_seconds(stop_time);
  const auto interval = [&](std::size_t i) {
    return to_seconds(times_[place(i)] - times_[place(i + 1)]);
  };
  for (std::size_t d = 0; d < dimensions_; ++d) {
    const auto position = [&](std::size_t i) { return positions_[place(i) * dimensions_ + d]; };
    const auto slope = [&](std::size_t i) { return (position(i) - position(i + 1)) / interval(i); };
    for (std::size_t i = 0; i < chords; ++i) values_[i] = std::abs(slope(i));
    const double velocity = quantile(chords);
    for (std::size_t i = 0; i + 1 < chords; ++i) {
      values_[i] = std::abs(slope(i) - slope(i + 1)) * 2 / (interval(i) + interval(i + 1));
    }
    const double acceleration = quantile(chords - std::min<std::size_t>(chords, 1));
    limits_.velocity[d] = kFactor * velocity;
    limits_.acceleration[d] = std::max(kFactor * acceleration, velocity / stop);
  }
}

}  // namespace splinecast::ipc
