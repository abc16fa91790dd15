#include "support/trapped_page.hpp"

#include <sys/mman.h>

#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <system_error>
#include <utility>

#include "splinecast/ipc/layout.hpp"

namespace splinecast::testing {
namespace {

void* trapped = nullptr;  ///< nullptr once it has been accessed
std::function<void()> action;
struct sigaction previous {};

void release() noexcept {
  if (trapped == nullptr) return;
  if (mprotect(trapped, ipc::kPage, PROT_READ | PROT_WRITE) != 0) std::abort();
  trapped = nullptr;
}

/// Any other fault goes to the action before, when the access is repeated.
void on_fault(int, siginfo_t* info, void*) {
  const auto at = reinterpret_cast<std::uintptr_t>(info->si_addr);  // NOLINT(*-reinterpret-cast)
  const auto page = reinterpret_cast<std::uintptr_t>(trapped);      // NOLINT(*-reinterpret-cast)
  if (trapped == nullptr || at < page || at - page >= ipc::kPage) {
    sigaction(SIGSEGV, &previous, nullptr);
    return;
  }
  release();
  action();
}

}  // namespace

TrappedPage::TrappedPage(void* address, std::function<void()> act) {
  const auto at = reinterpret_cast<std::uintptr_t>(address);  // NOLINT(*-reinterpret-cast)
  action = std::move(act);
  trapped = static_cast<std::byte*>(address) - at % ipc::kPage;
  struct sigaction handler {};
  handler.sa_sigaction = on_fault;
  handler.sa_flags = SA_SIGINFO;
  if (sigaction(SIGSEGV, &handler, &previous) != 0 ||
      mprotect(trapped, ipc::kPage, PROT_NONE) != 0) {
    throw std::system_error(errno, std::generic_category(), "cannot trap a page");
  }
}

TrappedPage::~TrappedPage() {
  release();
  sigaction(SIGSEGV, &previous, nullptr);
}

bool TrappedPage::has_acted() noexcept { return trapped == nullptr; }

}  // namespace splinecast::testing
