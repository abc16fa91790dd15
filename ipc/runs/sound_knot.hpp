#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "core/solvers/knot_ring.hpp"
#include "splinecast/waypoint.hpp"

/// Whether a curve can continue from a knot that was read back, from a board or from a recording.
/// Formulas only; nothing allocates or throws. O(D).
namespace splinecast::ipc {

[[nodiscard]] inline bool are_finite(std::span<const double> values) noexcept {
  return std::ranges::all_of(values, [](double value) { return std::isfinite(value); });
}

/// Whether all numbers of a knot and of its row are finite, and its time is in range.
[[nodiscard]] inline bool is_sound(const core::Knot& knot) noexcept {
  const core::Prefix& prefix = knot.prefix;
  const std::array row{prefix.gamma, prefix.smoothing.pivot, prefix.smoothing.lower1,
                       prefix.smoothing.lower2};
  return is_time_in_range(knot.time) && are_finite(row) && are_finite(knot.waypoint) &&
         are_finite(knot.g) && are_finite(knot.position) && are_finite(knot.velocity) &&
         are_finite(knot.acceleration) && are_finite(knot.residual);
}

}  // namespace splinecast::ipc
