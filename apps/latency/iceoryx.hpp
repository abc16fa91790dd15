#pragma once

#include <optional>
#include <string>

#include "apps/latency/options.hpp"
#include "apps/latency/stamps.hpp"

namespace splinecast::apps {

/// The latencies of a general zero-copy transport with the same work, or why they were not
/// measured.
struct LatencyPeer {
  std::optional<Latencies> seen;
  std::string reason;
};

/// Sends the schedule's waypoints, as many bytes each, through iceoryx from a process with the
/// producer's settings to one with the first reader's, polling or waiting as the mode says. Starts
/// iceoryx's daemon, iox-roudi, for that time; uses a daemon that already runs. Does not throw if
/// iceoryx is missing.
[[nodiscard]] LatencyPeer measure_iceoryx(const LatencyOptions& options);

}  // namespace splinecast::apps
