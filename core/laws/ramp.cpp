#include "core/laws/ramp.hpp"

#include <algorithm>
#include <cmath>

namespace splinecast::core {
namespace {

/// The state at the end of a part in which the rate is the cubic Hermite interpolant from
/// (from.rate, from.slope) to (rate, 0).
LawState end_of_part(const LawState& from, double rate, Time duration) noexcept {
  const double h = to_seconds(duration);
  return {.time = from.time + duration,
          .position = from.position + (h * (from.rate + rate) / 2 + h * h * from.slope / 12),
          .rate = rate,
          .slope = 0};
}

}  // namespace

// The rate changes by a third of slope times time, monotonically (Fritsch and Carlson 1980).
Time first_part(const LawState& from, Time duration, double largest) noexcept {
  if (from.slope == 0) return {};
  const double change = from.slope < 0 ? from.rate : std::max(largest - from.rate, 0.0);
  const double quarter = to_seconds(duration) / 4;
  const double seconds = std::min(quarter, 3 * change / std::abs(from.slope));
  // Rounded down, so that the rate stays within its bounds.
  return std::max(Time(static_cast<Time::rep>(std::floor(seconds * 1e9))), Time(1));
}

Ramp plan_ramp(const LawState& from, double rate, Time duration, double largest) noexcept {
  Ramp ramp;
  LawState begin = from;
  if (from.slope != 0) {
    const Time flatten = first_part(from, duration, largest);
    const double reached = from.rate + from.slope * to_seconds(flatten) / 3;
    begin = end_of_part(from, std::clamp(reached, 0.0, largest), flatten);
    ramp.add(begin);
  }
  ramp.add(end_of_part(begin, rate, duration));
  return ramp;
}

RampPeaks peaks_of_ramp(double from, double to, Time duration) noexcept {
  const double h = to_seconds(duration);
  const double change = std::abs(to - from);
  return {.slope = 1.5 * change / h, .curvature = 6 * change / (h * h)};
}

}  // namespace splinecast::core
