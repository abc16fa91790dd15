#include "core/limits/limit_of.hpp"

#include <algorithm>
#include <cmath>

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
  };
  std::size_t d = 0;
  for (const QuaternionDimensions& q : kinds.quaternions()) {
    for (; d < q.first; ++d) clamp(d);
    d += kQuaternionSize;
    const double most = limit_of(limits.acceleration, q.first);
    if (most == 0) continue;
    double speed = 0;
    double size = 0;
    for (std::size_t i = q.first; i < d; ++i) {
      speed = std::hypot(speed, velocity[i]);
      size = std::hypot(size, acceleration[i]);
    }
    const double allowed = std::max(most / 2 - 2 * speed * speed, 0.0);
    if (size <= allowed) continue;
    for (std::size_t i = q.first; i < d; ++i) {
      // −0 becomes 0, as when a curve is evaluated.
      acceleration[i] = acceleration[i] * (allowed / size) + 0.0;
    }
  }
  for (; d < acceleration.size(); ++d) clamp(d);
}

}  // namespace splinecast::core
