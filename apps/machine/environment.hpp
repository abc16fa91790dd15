#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "splinecast/time.hpp"

namespace splinecast::apps {

/// What of a machine bears on latencies: every measurement names it. A text that the machine does
/// not say is empty.
struct Environment {
  std::string version;     ///< of splinecast
  std::string cpu;         ///< model
  std::string online;      ///< CPUs that run, as a list such as `0-3,6`
  std::string isolated;    ///< CPUs that the scheduler leaves alone (isolcpus), likewise
  std::string governor;    ///< of the CPUs' frequency; several are joined by commas
  std::string kernel;      ///< release
  std::string preemption;  ///< `PREEMPT_RT`, `PREEMPT_DYNAMIC`, `PREEMPT` or `none`
  std::string hypervisor;  ///< what the machine is virtual under: maker and product, else
                           ///< `unknown`; empty on bare metal
  std::string clock;       ///< the kernel's clock source, such as `tsc`
  std::string rt_runtime;  ///< microseconds of each period that SCHED_FIFO may take of a CPU; -1:
                           ///< no limit
  std::string rt_period;   ///< the period, in microseconds
};

/// How long in each period the kernel stops SCHED_FIFO processes that would take a whole CPU, so
/// that others run. Zero if it does not; nothing if the machine does not say.
[[nodiscard]] std::optional<Time> throttled_time(const Environment& environment);

/// Reads it from /proc and /sys under `root`. Never throws for a file that is missing.
[[nodiscard]] Environment read_environment(const std::filesystem::path& root = "/");

[[nodiscard]] nlohmann::ordered_json to_json(const Environment& environment);

}  // namespace splinecast::apps
