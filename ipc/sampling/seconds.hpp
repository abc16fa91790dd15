#pragma once

#include "ipc/memory/word.hpp"
#include "splinecast/time.hpp"

namespace splinecast::ipc {

/// Seconds from a segment's left end, without signed overflow for any content of the region.
[[nodiscard]] inline double seconds_after(Time left, Time t) noexcept {
  return to_seconds(to_time(to_word(t) - to_word(left)));
}

}  // namespace splinecast::ipc
