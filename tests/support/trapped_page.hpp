#pragma once

#include <cstddef>
#include <functional>

namespace splinecast::testing {

/// Lets a test act between two loads of the code that it tests: the first access of this thread to
/// the page of `address` runs `act` and then goes on, with the page accessible again. The page must
/// be mapped and not be part of a stack; `act` may access it. One at a time in a process.
class TrappedPage {
 public:
  TrappedPage(void* address, std::function<void()> act);
  TrappedPage(const TrappedPage&) = delete;
  TrappedPage& operator=(const TrappedPage&) = delete;
  ~TrappedPage();

  /// Whether the page has been accessed.
  [[nodiscard]] static bool has_acted() noexcept;
};

}  // namespace splinecast::testing
