#pragma once

#include <cstdint>

#include "splinecast/time.hpp"

namespace splinecast::ipc {

/// Whether the process of this id is the one that had it at an instant of CLOCK_MONOTONIC, and
/// still runs. True where that cannot be known. System calls.
[[nodiscard]] bool process_lives(std::uint64_t pid, Time since) noexcept;

}  // namespace splinecast::ipc
