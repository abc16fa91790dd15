#pragma once

#include <sys/types.h>

#include <cstddef>
#include <optional>
#include <vector>

#include "splinecast/time.hpp"

namespace splinecast::apps {

/// Memory and open files of a process.
struct ProcessUse {
  std::size_t mapped_bytes = 0;    ///< address space
  std::size_t resident_bytes = 0;  ///< part of it in memory, shared pages included
  std::size_t private_bytes = 0;   ///< part of the resident pages that is not shared
  std::size_t descriptors = 0;     ///< open files
};

/// Reads the use of a living process of this user from /proc; nothing if it has ended. Makes system
/// calls and allocates.
[[nodiscard]] std::optional<ProcessUse> process_use(pid_t pid);

/// CPU time that all threads of a process have used so far; 0 if there is no such process.
[[nodiscard]] Time cpu_time(pid_t pid) noexcept;

/// Detects growth of a value over a run: skips the first quarter of the values as warm-up, then
/// compares the largest value in the second half of the rest with the largest in its first half.
/// It counts values, not time: while the machine stops this process, nothing is measured.
class Flatness {
 public:
  /// An increase of the largest value by more than `tolerance` is growth.
  explicit Flatness(std::size_t tolerance) : tolerance_(tolerance) {}

  void add(std::size_t value) { values_.push_back(value); }

  /// The largest values of the two halves; 0 of a half without values.
  [[nodiscard]] std::size_t first() const noexcept;
  [[nodiscard]] std::size_t second() const noexcept;
  [[nodiscard]] bool has_grown() const noexcept { return second() > first() + tolerance_; }

 private:
  [[nodiscard]] std::size_t most(std::size_t begin, std::size_t end) const noexcept;

  std::size_t tolerance_;
  std::vector<std::size_t> values_;
};

}  // namespace splinecast::apps
