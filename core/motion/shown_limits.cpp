#include "core/motion/shown_limits.hpp"

#include <algorithm>
#include <cmath>

#include "core/basics/quantile.hpp"

namespace splinecast::core {

ShownLimits::ShownLimits(std::size_t dimensions)
    : dimensions_(dimensions), times_(kMost), positions_(kMost * dimensions), values_(kMost) {
  limits_.velocity.resize(dimensions);
  limits_.acceleration.resize(dimensions);
}

void ShownLimits::take(Time time, std::span<const double> position) noexcept {
  const std::size_t at = count_++ % kMost;
  first_ = std::max(first_, count_ - std::min(count_, kMost));
  times_[at] = time;
  next_ = (time / kStep + 1) * kStep;
  has_looked_ = false;
  std::ranges::copy(position, std::span(positions_).subspan(at * dimensions_).begin());
}

void ShownLimits::forget_from(Time time) noexcept {
  is_replaced_ = false;
  forget_after(time - Time(1));
}

void ShownLimits::forget_all() noexcept {
  count_ = first_ = 0;
  is_replaced_ = false;
  next_ = Time::min();
  has_looked_ = false;
}

void ShownLimits::forget_after(Time t) noexcept {
  if (count_ == first_ || times_[place(0)] <= t) return;
  while (count_ > first_ && times_[place(0)] > t) --count_;
  has_looked_ = false;
  if (count_ == first_) return forget_all();
  next_ = (times_[place(0)] / kStep + 1) * kStep;
}

/// The 95 % quantile of the first `count` values; 0 if there are none.
double ShownLimits::quantile(std::size_t count) noexcept {
  return core::quantile(std::span(values_).first(count), 0.95);
}

void ShownLimits::look(Time stop_length) noexcept {
  if (has_looked_) return;
  has_looked_ = true;
  std::size_t kept = count_ - first_;
  while (kept > 0 && times_[place(0)] - times_[place(kept - 1)] > kSpan) --kept;
  const std::size_t chords = kept - std::min<std::size_t>(kept, 1);
  const double stop = to_seconds(stop_length);
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

}  // namespace splinecast::core
