#pragma once

#include <nlohmann/json.hpp>

namespace splinecast::apps {

/// What reading CLOCK_MONOTONIC costs on this machine, and how fine it is.
struct ClockMeasure {
  double cost_ns = 0;        ///< of one reading: the median over batches
  double resolution_ns = 0;  ///< the least step between two readings that differ
  double claimed_ns = 0;     ///< what clock_getres says
};

/// Measures for some milliseconds.
[[nodiscard]] ClockMeasure measure_clock();

[[nodiscard]] nlohmann::ordered_json to_json(const ClockMeasure& measure);

}  // namespace splinecast::apps
