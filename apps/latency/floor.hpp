#pragma once

#include <string>

#include "apps/latency/options.hpp"
#include "apps/timing/histogram.hpp"

namespace splinecast::apps {

/// The lower bound of the latency between two processes through memory on these CPUs.
struct LatencyFloor {
  Histogram one_way;   ///< half of each round trip; empty if it could not be measured
  std::string reason;  ///< why it was not measured
};

/// Measures the floor: two processes, with the settings of the producer and the first reader, spin
/// and exchange a number over two cache lines, one per direction, with release stores and acquire
/// loads. At most 100,000 round trips and 0.5 s.
[[nodiscard]] LatencyFloor measure_floor(const LatencyOptions& options);

}  // namespace splinecast::apps
