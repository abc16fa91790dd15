#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "splinecast/time.hpp"

namespace splinecast::apps {

/// Properties of a machine that affect latencies; every measurement lists them. An unknown one is
/// empty.
struct Environment {
  std::string version;     ///< of splinecast
  std::string cpu;         ///< model
  std::string online;      ///< CPUs that are online, as a list such as `0-3,6`
  std::string isolated;    ///< CPUs isolated from the scheduler (isolcpus), as a list
  std::string governor;    ///< of the CPUs' frequency; several are joined by commas
  std::string kernel;      ///< release
  std::string preemption;  ///< `PREEMPT_RT`, `PREEMPT_DYNAMIC`, `PREEMPT` or `none`
  std::string hypervisor;  ///< of a virtual machine: vendor and product, else `unknown`;
                           ///< empty on bare metal
  std::string clock;       ///< the kernel's clock source, such as `tsc`
  std::string rt_runtime;  ///< microseconds of each period that SCHED_FIFO may take of a CPU; -1:
                           ///< no limit
  std::string rt_period;   ///< the period, in microseconds
};

/// The time in each period for which the kernel stops SCHED_FIFO processes that use a whole CPU, so
/// that others run. Zero if it does not; nullopt if that is unknown.
[[nodiscard]] std::optional<Time> throttled_time(const Environment& environment);

/// Reads the environment from /proc and /sys under `root`. Never throws for a file that is missing.
[[nodiscard]] Environment read_environment(const std::filesystem::path& root = "/");

[[nodiscard]] nlohmann::ordered_json to_json(const Environment& environment);

}  // namespace splinecast::apps
