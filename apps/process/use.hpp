#pragma once

#include <sys/types.h>

#include <cstddef>
#include <optional>

#include "splinecast/time.hpp"

namespace splinecast::apps {

/// What a process has of the machine.
struct ProcessUse {
  std::size_t mapped_bytes = 0;    ///< address space
  std::size_t resident_bytes = 0;  ///< of that in memory, with what it shares with others
  std::size_t private_bytes = 0;   ///< of that its own
  std::size_t descriptors = 0;     ///< open files
};

/// Asks the kernel about a living process of this user; nothing if it has ended. System calls.
[[nodiscard]] std::optional<ProcessUse> process_use(pid_t pid);

/// CPU time that a process has taken so far, all of its threads together; 0 if there is none.
[[nodiscard]] Time cpu_time(pid_t pid) noexcept;

/// Whether something stays flat over a run: the largest value of its second half, after a quarter
/// for warming up, against the largest of the first half.
class Flatness {
 public:
  /// A value counts as grown if it exceeds the first half's largest by more than `tolerance`.
  explicit Flatness(std::size_t tolerance) : tolerance_(tolerance) {}

  /// Takes a value at a share of the run, 0 to 1.
  void add(double share, std::size_t value) noexcept;

  [[nodiscard]] std::size_t first() const noexcept { return first_; }
  [[nodiscard]] std::size_t second() const noexcept { return second_; }
  [[nodiscard]] bool has_grown() const noexcept { return second_ > first_ + tolerance_; }

 private:
  std::size_t tolerance_;
  std::size_t first_ = 0;
  std::size_t second_ = 0;
};

}  // namespace splinecast::apps
