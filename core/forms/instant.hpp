#pragma once

#include <algorithm>

#include "splinecast/state.hpp"
#include "splinecast/waypoint.hpp"

/// An instant, which is a view, and a state, which owns its values. O(D); nothing allocates.
namespace splinecast::core {

/// A view of a state at a time. Valid until the state changes.
[[nodiscard]] inline Instant instant_of(Time time, const State& state) noexcept {
  return {time, state.position(), state.velocity(), state.acceleration()};
}

/// Copies position, velocity and acceleration; the spans have D values. The jerk stays.
inline void copy_values(const Instant& from, State& to) noexcept {
  const StateRef out = to.ref();
  std::ranges::copy(from.position, out.position.begin());
  std::ranges::copy(from.velocity, out.velocity.begin());
  std::ranges::copy(from.acceleration, out.acceleration.begin());
}

}  // namespace splinecast::core
