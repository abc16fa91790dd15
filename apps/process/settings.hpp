#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace splinecast::apps {

/// How a process is to run where latencies matter.
struct ProcessSettings {
  std::optional<int> cpu{};  ///< the only one to run on
  bool fifo = false;         ///< SCHED_FIFO with this priority, 1 to 99
  int priority = 50;
  bool lock_memory = false;  ///< mlockall, also for what comes
};

/// Makes them those of this process, and looks whether they took effect. Returns what did not, and
/// why, as messages that begin with `role`. Sleeps of this process become exact to the nanosecond
/// as far as the kernel's timers go (the slack of 50 µs is taken off).
[[nodiscard]] std::vector<std::string> adopt(const ProcessSettings& settings,
                                             const std::string& role);

/// How many CPUs this process may run on.
[[nodiscard]] std::size_t usable_cpus();

/// What the kernel counts of a process, since it began.
struct Usage {
  std::int64_t minor_faults = 0;
  std::int64_t major_faults = 0;
  std::int64_t voluntary_switches = 0;
  std::int64_t involuntary_switches = 0;
};

/// Of this process until now. One system call.
[[nodiscard]] Usage usage_now() noexcept;

/// What came between two looks.
[[nodiscard]] nlohmann::ordered_json to_json(const Usage& before, const Usage& after);

}  // namespace splinecast::apps
