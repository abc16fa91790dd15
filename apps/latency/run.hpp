#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apps/latency/floor.hpp"
#include "apps/latency/iceoryx.hpp"
#include "apps/latency/options.hpp"
#include "apps/latency/stamps.hpp"
#include "apps/machine/environment.hpp"
#include "apps/timing/clock_measure.hpp"

namespace splinecast::apps {

/// The result of `latency`.
struct LatencyResult {
  LatencyOptions options;
  Environment environment;
  ClockMeasure clock;
  std::vector<std::string> warnings;  ///< settings without effect, and what spoils the figures
  bool interrupted = false;
  std::vector<Latencies> stages;  ///< of the pipeline, in its order
  LatencyFloor floor;
  LatencyPeer iceoryx;
  nlohmann::ordered_json processes;  ///< a list of `role` and the kernel's counts
  nlohmann::ordered_json solver;     ///< its counters
};

/// A warning if the kernel stops spinning SCHED_FIFO processes, or may do so: the measured
/// latencies then include these stops. Empty if it does not, or if no process spins.
[[nodiscard]] std::string throttling_warning(const LatencyOptions& options,
                                             const Environment& environment);

/// Measures the floor, the pipeline and, unless disabled, iceoryx, one after the other, in new
/// processes and on a new stream. Takes twice the warm-up and the duration. Throws Failure or
/// TimeOut if the pipeline cannot be measured.
[[nodiscard]] LatencyResult run_latency(const LatencyOptions& options);

}  // namespace splinecast::apps
