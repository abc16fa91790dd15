#include "core/online/extrapolation.hpp"

#include <algorithm>
#include <array>

#include "core/forms/stop.hpp"

namespace splinecast::core {

Extrapolation::Extrapolation(std::size_t dimensions) : from_(dimensions), stop_(dimensions) {}

void Extrapolation::begin(const SlidingWindow& target) noexcept {
  constexpr std::array<double, kMaxDimensions> kZeros{};
  const std::size_t dimensions = target.dimensions();
  const Knot newest = target.knot(target.knots() - 1);
  const WindowOptions& options = target.options();
  begin_ = newest.time;
  line_end_ = begin_ + kLine;
  const StateRef from = from_.ref();
  std::ranges::copy(newest.position, from.position.begin());
  std::ranges::copy(newest.velocity, from.velocity.begin());
  for (std::size_t d = 0; d < options.limits.velocity.size(); ++d) {
    const double most = kLineShare * options.limits.velocity[d];
    if (most > 0) from.velocity[d] = std::clamp(from.velocity[d], -most, most);
  }
  std::array<double, kMaxDimensions> values;  // NOLINT(*-member-init)
  const auto position = std::span(values).first(dimensions);
  const double line = to_seconds(kLine);
  for (std::size_t d = 0; d < dimensions; ++d) {
    position[d] = from.position[d] + line * from.velocity[d];
  }
  const auto zeros = std::span(kZeros).first(dimensions);
  const Time length = stop_time_within(options.limits, options.stop_time, from.velocity, zeros);
  build_stop(line_end_, length, position, from.velocity, zeros, stop_);
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
