#pragma once

#include <cstddef>
#include <span>

#include "splinecast/dimension_kind.hpp"

namespace splinecast::core {

/// Calls take_one(dimension) for each dimension outside quaternions and take_rotation(quaternion)
/// for each quaternion, in the order of the dimensions. Stops and returns false if a call returns
/// false.
bool for_all(std::span<const QuaternionDimensions> quaternions, std::size_t dimensions,
             const auto& take_one, const auto& take_rotation) noexcept {
  for (std::size_t d = 0; d < dimensions;) {
    const bool is_rotation = !quaternions.empty() && quaternions.front().first == d;
    if (!(is_rotation ? take_rotation(quaternions.front()) : take_one(d))) return false;
    if (is_rotation) quaternions = quaternions.subspan(1);
    d += is_rotation ? kQuaternionSize : 1;
  }
  return true;
}

}  // namespace splinecast::core
