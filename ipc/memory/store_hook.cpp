#include "ipc/memory/store_hook.hpp"

#include <atomic>
#include <csignal>

namespace splinecast::ipc {
namespace {

/// Counts down to the store before which this process is killed; 0: never.
std::atomic<std::uint64_t> stores_left{0};

}  // namespace

void kill_before_store(std::uint64_t n) noexcept { stores_left = n; }

void before_store() noexcept {
  if (stores_left == 0) return;
  if (--stores_left == 0) raise(SIGKILL);
}

}  // namespace splinecast::ipc
