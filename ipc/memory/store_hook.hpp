#pragma once

#include <cstdint>

/// A hook before every store to shared memory, by which a test can kill the process between any two
/// stores: only in a build with SPLINECAST_HOOKS. In any other build it is empty and costs nothing.
namespace splinecast::ipc {

#ifdef SPLINECAST_HOOKS
/// Kills this process (SIGKILL) before the n-th store from now, n ≥ 1; 0 cancels. Counts the stores
/// of all threads together.
void kill_before_store(std::uint64_t n) noexcept;

/// Called before each store.
void before_store() noexcept;
#else
inline void before_store() noexcept {}
#endif

}  // namespace splinecast::ipc
