#include "core/forms/way_between.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/forms/entry.hpp"
#include "core/limits/limit_of.hpp"

namespace splinecast::core {
namespace {

/// Duration of an entry in a dimension without limits: that of the motion which
/// an entry may always have without limits.
constexpr double kUnlimitedSeconds = 1;

}  // namespace

void WayBetween::measure(std::span<const double> from, std::span<const double> to) noexcept {
  std::ranges::copy(to, to_.begin());
  kinds_.continue_from(from, {.position = to_});
  for (std::size_t d = 0; d < to_.size(); ++d) distances_[d] = std::abs(to_[d] - from[d]);
  for (const QuaternionDimensions& q : kinds_.quaternions()) {
    const auto parts = std::span(distances_).subspan(q.first, kQuaternionSize);
    double square = 0;
    for (const double part : parts) square += part * part;
    const double chord = std::min(std::sqrt(square), std::numbers::sqrt2);
    std::ranges::fill(parts, 4 * std::asin(chord / 2));
  }
}

std::optional<double> WayBetween::seconds(std::size_t d,
                                          const MotionLimits& limits) const noexcept {
  const double velocity = limit_of(limits.velocity, d);
  const double acceleration = limit_of(limits.acceleration, d);
  const double jerk = limit_of(limits.jerk, d);
  if (velocity == 0 && acceleration == 0 && jerk == 0) return std::nullopt;
  const bool is_rotation = std::ranges::any_of(kinds_.quaternions(), [d](const auto& q) {
    return d >= q.first && d < q.first + kQuaternionSize;
  });
  // A rotation along a chord is fastest in its middle.
  const double way = is_rotation ? 4 * std::tan(distances_[d] / 4) : distances_[d];
  return seconds_from_rest(way, velocity, acceleration, jerk);
}

Time WayBetween::entry_time(const MotionLimits& limits) const noexcept {
  double longest = 0;
  for (std::size_t d = 0; d < distances_.size(); ++d) {
    if (distances_[d] == 0) continue;
    longest = std::max(longest, seconds(d, limits).value_or(kUnlimitedSeconds));
  }
  return from_seconds(longest);
}

}  // namespace splinecast::core
