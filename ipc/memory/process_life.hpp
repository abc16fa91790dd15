#pragma once

#include <cstdint>

#include "splinecast/time.hpp"

namespace splinecast::ipc {

/// Whether process `pid` lives and is the process that had this id at time `since` of
/// CLOCK_MONOTONIC. True if that cannot be determined. System calls.
[[nodiscard]] bool process_lives(std::uint64_t pid, Time since) noexcept;

}  // namespace splinecast::ipc
