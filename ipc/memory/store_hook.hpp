#pragma once

#include <cstdint>

/// A hook that runs before every store to shared memory. In a build with SPLINECAST_HOOKS, a test
/// can use it to kill the process between any two stores. In any other build it is empty and costs
/// nothing.
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
