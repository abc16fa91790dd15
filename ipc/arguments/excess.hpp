#pragma once

#include "splinecast.h"
#include "splinecast/limits.hpp"

namespace splinecast::ipc {

[[nodiscard]] inline splinecast_excess excess_of(const Excess& excess) noexcept {
  return {.ratio = excess.ratio,
          .value = excess.value,
          .limit = excess.limit,
          .dimension = excess.dimension,
          .kind = static_cast<int>(excess.kind),
          .reserved = 0};
}

}  // namespace splinecast::ipc
