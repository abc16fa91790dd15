#include "core/motion/extrapolation.hpp"

#include <algorithm>

#include "core/forms/stop.hpp"

namespace splinecast::core {

Extrapolation::Extrapolation(std::size_t dimensions)
    : from_(dimensions), to_(dimensions), stop_(dimensions) {}

void Extrapolation::begin(const SlidingWindow& target) noexcept {
  begin_line(target);
  stop_after(stop_time_within(target.stop_rules(), line_end_state()));
}

void Extrapolation::begin_line(const SlidingWindow& target) noexcept {
  const Knot newest = target.knot(target.knots() - 1);
  const MotionLimits& limits = target.limits_at_largest_rate();
  begin_ = newest.time;
  line_end_ = begin_ + kLineLength;
  const StateRef from = from_.ref();
  std::ranges::copy(newest.position, from.position.begin());
  std::ranges::copy(newest.velocity, from.velocity.begin());
  for (std::size_t d = 0; d < limits.velocity.size(); ++d) {
    const double most = kLineShare * limits.velocity[d];
    if (most > 0) from.velocity[d] = std::clamp(from.velocity[d], -most, most);
  }
  const double line = to_seconds(kLineLength);
  for (std::size_t d = 0; d < from.position.size(); ++d) {
    to_.ref().position[d] = from.position[d] + line * from.velocity[d];
  }
  std::ranges::copy(from.velocity, to_.ref().velocity.begin());
  std::ranges::fill(to_.ref().acceleration, 0.0);
}

void Extrapolation::stop_after(Time length) noexcept {
  const Instant end = line_end_state();
  build_stop(line_end_, length, end.position, end.velocity, end.acceleration, stop_);
}

void Extrapolation::state_at(Time t, const StateRef& out) const noexcept {
  if (t > line_end_) {
    evaluate(stop_.order, stop_.coefficients, to_seconds(std::min(t, stop_.right) - stop_.left),
             out);
    if (t < stop_.right) return;
    std::ranges::fill(out.velocity, 0.0);
  } else {
    const double u = to_seconds(t - begin_);
    for (std::size_t d = 0; d < out.position.size(); ++d) {
      out.position[d] = from_.position()[d] + u * from_.velocity()[d];
    }
    std::ranges::copy(from_.velocity(), out.velocity.begin());
  }
  std::ranges::fill(out.acceleration, 0.0);
}

}  // namespace splinecast::core
