#pragma once

#include <cstddef>
#include <vector>

namespace splinecast::core {

/// The limit of dimension d in a list of MotionLimits; 0: none.
[[nodiscard]] inline double limit_of(const std::vector<double>& limits, std::size_t d) noexcept {
  return limits.empty() ? 0 : limits[d];
}

}  // namespace splinecast::core
