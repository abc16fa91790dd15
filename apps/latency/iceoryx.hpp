#pragma once

#include <optional>
#include <string>

#include "apps/latency/options.hpp"
#include "apps/latency/stamps.hpp"

namespace splinecast::apps {

/// What a general zero-copy transport does with the same work, or why that was not measured.
struct LatencyPeer {
  std::optional<Latencies> seen;
  std::string reason;
};

/// Sends the schedule's waypoints, as many bytes each, through iceoryx from a process set up as the
/// producer to one set up as the first reader, polling or waiting as the mode says. Starts
/// iceoryx's daemon, iox-roudi, for as long as that takes; one that runs already is used. Never
/// throws for want of iceoryx.
[[nodiscard]] LatencyPeer measure_iceoryx(const LatencyOptions& options);

}  // namespace splinecast::apps
