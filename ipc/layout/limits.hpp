#pragma once

#include "ipc/layout/header.hpp"
#include "splinecast/limits.hpp"

namespace splinecast::ipc {

/// The motion limits in a header, and the action for a segment that exceeds them.
[[nodiscard]] MotionLimits motion_limits(const RegionHeader& header);
[[nodiscard]] Beyond beyond(const RegionHeader& header) noexcept;

/// Writes limits into a header that already has dimensions and kinds; limits that are not given
/// become "none". Throws std::invalid_argument for limits that require_limits refuses.
void put_limits(const MotionLimits& limits, RegionHeader& header);

}  // namespace splinecast::ipc
