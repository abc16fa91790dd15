#pragma once

#include "ipc/layout/header.hpp"
#include "splinecast/limits.hpp"

namespace splinecast::ipc {

/// What a header says of limits of motion, and of what is done about a segment beyond them.
[[nodiscard]] MotionLimits motion_limits(const RegionHeader& header);
[[nodiscard]] Beyond beyond(const RegionHeader& header) noexcept;

/// Writes limits into a header whose dimensions and their kinds are known; what is not given says
/// "none". Throws std::invalid_argument for limits that require_limits does not take.
void put_limits(const MotionLimits& limits, RegionHeader& header);

}  // namespace splinecast::ipc
