#pragma once

#include <string>

#include "apps/latency/options.hpp"
#include "apps/timing/histogram.hpp"

namespace splinecast::apps {

/// The least that any way from process to process through memory can cost on these CPUs.
struct LatencyFloor {
  Histogram one_way;   ///< half of each round trip; empty if it could not be measured
  std::string reason;  ///< why not
};

/// Measures it: two processes, set up as the producer and the first reader are, hand a number back
/// and forth over two cache lines, one each way, release and acquire, spinning. At most 100,000
/// round trips and half a second.
[[nodiscard]] LatencyFloor measure_floor(const LatencyOptions& options);

}  // namespace splinecast::apps
