#include "splinecast/ipc/shown_motion.hpp"

#include <algorithm>
#include <cmath>

#include "splinecast/ipc/curve_cut.hpp"

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

void ShownMotion::take(core::Time time, std::span<const double> position) noexcept {
  const std::size_t at = count_++ % kMost;
  times_[at] = newest_ = time;
  std::ranges::copy(position, std::span(positions_).subspan(at * dimensions_).begin());
}

void ShownMotion::restore(const core::SlidingWindow& window, const KnotBoardReader& board,
                          const Head& head) noexcept {
  count_ = 0;
  if (window.knots() == 0) return;
  // Back from the window, about kStep apart, by the packed times.
  const core::Time end = window.time(window.oldest_segment());
  std::size_t found = 0;
  for (core::Time t = end - kStep; found < kMost && end - t < kSpan; t -= kStep) {
    const Word number = segment_at(board, head, t);
    if (found > 0 && number == numbers_[found - 1]) break;
    numbers_[found++] = number;
  }
  while (found > 0) {
    const bool is_there = board.copy_knot(numbers_[--found], head.revision, knot_);
    const bool is_met = is_there && knot_.note.is_waypoint && knot_.time < end &&
                        knot_.note.form != core::SegmentForm::none;
    if (is_met) note(knot_.time, knot_.waypoint());
  }
  for (std::size_t i = window.oldest_segment(); i < window.knots(); ++i) {
    const core::Knot knot = window.knot(i);
    note(knot.time, knot.waypoint);
  }
}

/// The 95 % quantile of the first `count` values; 0 if there are none.
double ShownMotion::quantile(std::size_t count) noexcept {
  if (count == 0) return 0;
  constexpr double kShare = 0.95;
  const auto rank = static_cast<std::size_t>(std::ceil(kShare * static_cast<double>(count))) - 1;
  const auto values = std::span(values_).first(count);
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(rank);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

void ShownMotion::look(core::Time stop_time) noexcept {
  const std::size_t kept = std::min(count_, kMost);
  const std::size_t chords = kept - std::min<std::size_t>(kept, 1);
  const double stop = core::to_seconds(stop_time);
  const auto interval = [&](std::size_t i) {
    return core::to_seconds(times_[place(i)] - times_[place(i + 1)]);
  };
  for (std::size_t d = 0; d < dimensions_; ++d) {
    const auto position = [&](std::size_t i) { return positions_[place(i) * dimensions_ + d]; };
    const auto slope = [&](std::size_t i) {
      return (position(i) - position(i + 1)) / interval(i);
    };
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
