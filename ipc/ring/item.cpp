#include "ipc/ring/item.hpp"

#include <algorithm>

#include "core/basics/magnitude.hpp"

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

}  // namespace splinecast::ipc
