#include "core/limits/limit_of.hpp"

#include <algorithm>
#include <cmath>

#include "core/limits/for_all.hpp"

namespace splinecast::core {

MotionLimits limits_at_rate(const MotionLimits& limits, double rate) {
  MotionLimits out = limits;
  double divisor = 1;
  for (std::vector<double>* const values : {&out.velocity, &out.acceleration, &out.jerk}) {
    divisor *= std::max(rate, 1.0);
    for (double& value : *values) value /= divisor;
  }
  return out;
}

void clamp_acceleration(const MotionLimits& limits, const DimensionKinds& kinds,
                        std::span<const double> velocity, std::span<double> acceleration) noexcept {
  const auto clamp = [&](std::size_t d) {
    const double most = limit_of(limits.acceleration, d);
    if (most > 0) acceleration[d] = std::clamp(acceleration[d], -most, most);
    return true;
  };
  const auto shorten = [&](const QuaternionDimensions& q) {
    const double most = limit_of(limits.acceleration, q.first);
    if (most == 0) return true;
    const std::size_t end = q.first + kQuaternionSize;
    double speed = 0;
    double size = 0;
    for (std::size_t d = q.first; d < end; ++d) {
      speed = std::hypot(speed, velocity[d]);
      size = std::hypot(size, acceleration[d]);
    }
    const double allowed = std::max(most / 2 - 2 * speed * speed, 0.0);
    if (size <= allowed) return true;
    for (std::size_t d = q.first; d < end; ++d) {
      // −0 becomes 0, as when a curve is evaluated.
      acceleration[d] = acceleration[d] * (allowed / size) + 0.0;
    }
    return true;
  };
  (void)for_all(kinds.quaternions(), acceleration.size(), clamp, shorten);
}

}  // namespace splinecast::core
