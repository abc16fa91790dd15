#include "ipc/ring/item.hpp"

#include <algorithm>
#include <cmath>

#include "core/basics/magnitude.hpp"
#include "ipc/layout/header.hpp"

namespace splinecast::ipc {

bool is_finite(std::span<const double> values) noexcept {
  // Fast path: if the sum of magnitudes is usable, every value is.
  return is_usable(core::magnitude_of(values)) || std::ranges::all_of(values, is_usable);
}

bool is_finite(const Waypoint& waypoint) noexcept {
  return is_finite(waypoint.position) &&
         (waypoint.velocity.empty() || is_finite(waypoint.velocity)) &&
         (waypoint.acceleration.empty() || is_finite(waypoint.acceleration));
}

Waypoint RingItem::waypoint() const noexcept {
  const std::size_t dimensions = values.size() / 3;
  const auto all = std::span<const double>(values);
  Waypoint waypoint{.time = time, .position = all.first(dimensions)};
  if (has_velocity) waypoint.velocity = all.subspan(dimensions, dimensions);
  if (has_acceleration) waypoint.acceleration = all.last(dimensions);
  return waypoint;
}

std::optional<RateItem> piece_of(const Waypoint& values) noexcept {
  constexpr double kLongest = 1e6;  // beyond any plan [s]
  if (values.position.size() != 1 || values.velocity.size() != 1) return std::nullopt;
  const double rate = values.position[0];
  const double length = values.velocity[0];
  if (!(rate >= 0 && rate <= kLargestRate)) return std::nullopt;
  if (!(length >= 1e-9 && length <= kLongest)) return std::nullopt;
  return RateItem{.end_rate = rate, .length = Time(std::llround(length * 1e9))};
}

}  // namespace splinecast::ipc
