#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "splinecast/dimension_kind.hpp"
#include "splinecast/limits.hpp"

namespace splinecast::core {

/// The limit of dimension d in a list of MotionLimits; 0: none.
[[nodiscard]] inline double limit_of(const std::vector<double>& limits, std::size_t d) noexcept {
  return limits.empty() ? 0 : limits[d];
}

/// The limits that a motion must keep at the rate 1 so that it keeps the given ones also at another
/// rate > 0: velocities divided by the rate, accelerations by its square, jerks by its cube. Bounds
/// do not change. A lower rate than 1 counts as 1. Allocates.
[[nodiscard]] MotionLimits limits_at_rate(const MotionLimits& limits, double rate);

/// Lowers each acceleration to its limit; that of a unit quaternion so far that |ω̇| ≤ 2|q̈| + 4|q̇|²
/// keeps it, or to 0. O(D).
void clamp_acceleration(const MotionLimits& limits, const DimensionKinds& kinds,
                        std::span<const double> velocity, std::span<double> acceleration) noexcept;

}  // namespace splinecast::core
