#include "splinecast/core/knot_ring.hpp"

#include <algorithm>
#include <bit>
#include <utility>

namespace splinecast::core {

KnotRing::KnotRing(std::size_t dimensions, std::size_t capacity, Condition start)
    : dimensions_(dimensions),
      start_(std::move(start)),
      mask_(std::bit_ceil(capacity) - 1),
      rows_(mask_ + 1),
      values_((mask_ + 1) * kValues * dimensions) {}

std::span<double> KnotRing::values(std::size_t i, Value which) noexcept {
  return std::span(values_).subspan(((i & mask_) * kValues + which) * dimensions_, dimensions_);
}

std::span<const double> KnotRing::values(std::size_t i, Value which) const noexcept {
  return std::span(values_).subspan(((i & mask_) * kValues + which) * dimensions_, dimensions_);
}

Neighbours KnotRing::neighbours(std::size_t i) const noexcept {
  return {.h_before = row(i - 1).h,
          .h_after = row(i).h,
          .chord_before = values(i - 1, kChord),
          .chord_after = values(i, kChord)};
}

void KnotRing::place(std::size_t i, Time time, std::span<const double> position) noexcept {
  row(i) = {.time = time, .h = 0, .gamma = 0};
  std::ranges::copy(position, values(i, kPosition).begin());
}

/// Length and chord slope of interval i.
void KnotRing::measure(std::size_t i) noexcept {
  const double h = to_seconds(row(i + 1).time - row(i).time);
  row(i).h = h;
  const auto x0 = values(i, kPosition);
  const auto x1 = values(i + 1, kPosition);
  const auto chord = values(i, kChord);
  for (std::size_t d = 0; d < dimensions_; ++d) chord[d] = (x1[d] - x0[d]) / h;
}

void KnotRing::eliminate(std::size_t i) noexcept {
  if (i == 0) {
    row(0).gamma = eliminate_first(start_, row(0).h, values(0, kChord), values(0, kG));
  } else {
    row(i).gamma =
        eliminate_interior(neighbours(i), row(i - 1).gamma, values(i - 1, kG), values(i, kG));
  }
}

void KnotRing::push(Time time, std::span<const double> position) noexcept {
  const std::size_t i = size_++;
  place(i, time, position);
  if (i > 0) {
    measure(i - 1);
    eliminate(i - 1);
  }
  const auto v = values(i, kVelocity);
  std::ranges::fill(v, 0.0);
  if (i == 0 && start_.kind == ConditionKind::velocity) std::ranges::copy(start_.value, v.begin());
}

void KnotRing::restore(std::size_t first, std::span<const Knot> knots) noexcept {
  for (std::size_t k = 0; k < knots.size(); ++k) {
    const Knot& knot = knots[k];
    place(first + k, knot.time, knot.position);
    row(first + k).gamma = knot.gamma;
    std::ranges::copy(knot.velocity, values(first + k, kVelocity).begin());
    std::ranges::copy(knot.g, values(first + k, kG).begin());
    if (k > 0) measure(first + k - 1);
  }
  size_ = first + knots.size();
}

void KnotRing::close(Tail tail) noexcept {
  const std::size_t n = newest();
  if (n == 0) return;
  const Neighbours last_two = n >= 2 ? neighbours(n - 1)
                                     : Neighbours{.h_before = 0,
                                                  .h_after = row(0).h,
                                                  .chord_before = {},
                                                  .chord_after = values(0, kChord)};
  solve_tail(tail, last_two, row(n - 1).gamma, values(n - 1, kG), values(n, kVelocity));
}

void KnotRing::close(const Condition& end) noexcept {
  const std::size_t n = newest();
  if (n == 0) return;
  halts_at_end_ = end.kind == ConditionKind::halt;
  solve_last(end, row(n - 1).h, values(n - 1, kChord), row(n - 1).gamma, values(n - 1, kG),
             values(n, kVelocity));
}

void KnotRing::back_substitute_to(std::size_t last) noexcept {
  for (std::size_t i = newest(); i-- > last;) {
    back_substitute(row(i).gamma, values(i, kG), values(i + 1, kVelocity), values(i, kVelocity));
  }
}

Knot KnotRing::knot(std::size_t i) const noexcept {
  return {.time = row(i).time,
          .gamma = row(i).gamma,
          .position = values(i, kPosition),
          .velocity = values(i, kVelocity),
          .g = values(i, kG)};
}

Interval KnotRing::interval(std::size_t i) const noexcept {
  return {.left = row(i).time,
          .right = row(i + 1).time,
          .h = row(i).h,
          .x0 = values(i, kPosition),
          .chord = values(i, kChord),
          .v0 = values(i, kVelocity),
          .v1 = values(i + 1, kVelocity),
          .halts_left = i == 0 && start_.kind == ConditionKind::halt,
          .halts_right = halts_at_end_ && i + 1 == newest()};
}

void write_acceleration_step(const KnotRing& knots, std::size_t i, bool held_before,
                             std::span<double> step) noexcept {
  const Interval after = knots.interval(i);
  const Interval before = i > 0 ? knots.interval(i - 1) : Interval{};
  for (std::size_t d = 0; d < step.size(); ++d) {
    if (i > 0) {
      step[d] = left_acceleration(after, d) - right_acceleration(before, d);
    } else {
      step[d] = held_before ? left_acceleration(after, d) : 0;
    }
  }
}

}  // namespace splinecast::core
