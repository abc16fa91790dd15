#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace splinecast::apps {

/// Scheduling and memory settings of a process with low latency.
struct ProcessSettings {
  std::optional<int> cpu{};  ///< the CPU to pin the process to
  bool fifo = false;         ///< run under SCHED_FIFO
  int priority = 50;         ///< of SCHED_FIFO, 1 to 99
  bool lock_memory = false;  ///< mlockall, current and future pages
};

/// Applies the settings to this process and verifies them. Returns a message for each one that
/// failed, with the reason; messages begin with `role`. Also sets the timer slack of this process
/// to 1 ns (default 50 µs).
[[nodiscard]] std::vector<std::string> adopt(const ProcessSettings& settings,
                                             const std::string& role);

/// Number of CPUs that this process may run on.
[[nodiscard]] std::size_t usable_cpus();

/// Counters that the kernel keeps for a process since its start.
struct Usage {
  std::int64_t minor_faults = 0;
  std::int64_t major_faults = 0;
  std::int64_t voluntary_switches = 0;
  std::int64_t involuntary_switches = 0;
};

/// The counters of this process. One system call.
[[nodiscard]] Usage usage_now() noexcept;

/// The differences between two readings.
[[nodiscard]] nlohmann::ordered_json to_json(const Usage& before, const Usage& after);

}  // namespace splinecast::apps
