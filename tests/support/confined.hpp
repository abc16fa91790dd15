#pragma once

#include <atomic>
#include <cstdint>
#include <functional>

namespace splinecast::testing {

/// What a confined process shares with the one that forked it.
struct ConfinedPage {
  enum Phase : int { warming_up, confined, running, done, released };
  std::atomic<int> phase;
  std::uint64_t allocations;  ///< of its thread between confine() and finish()
  std::atomic<std::uint64_t> rounds, answered, busy, midway, overtaken, cpu_ns;  ///< for the loop
};

/// The inside of a confined process: warm up, confine(), run the loop, finish().
class Confined {
 public:
  explicit Confined(ConfinedPage& page) : page_(&page) {}

  [[nodiscard]] ConfinedPage& page() const { return *page_; }

  /// From now on any system call but `exit_group` and `write` kills this process (SIGSYS). Waits,
  /// without one, until the parent has read how many pages it has faulted in so far.
  void confine();

  /// Ends the process with exit code 0, when the parent has read the page faults again.
  [[noreturn]] void finish();

 private:
  ConfinedPage* page_;
  std::uint64_t allocations_ = 0;
};

/// How a confined process ended, and what it did between confine() and finish().
struct ConfinedEnd {
  int code = -1;   ///< exit code; −1 if a signal killed it
  int signal = 0;  ///< the signal that killed it
  std::uint64_t allocations = 0, minor_faults = 0, major_faults = 0;
  std::uint64_t rounds = 0, answered = 0, busy = 0, midway = 0, overtaken = 0, cpu_ns = 0;
};

/// Forks a process that runs `inside`, and calls `meanwhile` over and over, in this one, until it
/// has ended. A process that does not end within kPatience is killed.
ConfinedEnd run_confined(const std::function<void(Confined&)>& inside,
                         const std::function<void()>& meanwhile = {});

}  // namespace splinecast::testing
