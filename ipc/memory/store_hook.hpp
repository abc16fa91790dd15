#pragma once

#include <cstdint>

/// What every store to shared memory passes first, so that a test can kill the process between any
/// two of them: only in a build with SPLINECAST_HOOKS. In any other it is nothing, and the code is
/// the same as without it.
namespace splinecast::ipc {

#ifdef SPLINECAST_HOOKS
/// Kills this process (SIGKILL) before the n-th store from now on, n ≥ 1; 0 takes that back. Counts
/// the stores of all threads together.
void kill_before_store(std::uint64_t n) noexcept;

/// Called before each store.
void before_store() noexcept;
#else
inline void before_store() noexcept {}
#endif

}  // namespace splinecast::ipc
