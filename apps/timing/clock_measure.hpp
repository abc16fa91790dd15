#pragma once

#include <nlohmann/json.hpp>

namespace splinecast::apps {

/// Cost and resolution of reading CLOCK_MONOTONIC on this machine.
struct ClockMeasure {
  double cost_ns = 0;        ///< of one reading: the median over batches
  double resolution_ns = 0;  ///< least difference of two different readings
  double claimed_ns = 0;     ///< from clock_getres
};

/// Takes some milliseconds.
[[nodiscard]] ClockMeasure measure_clock();

[[nodiscard]] nlohmann::ordered_json to_json(const ClockMeasure& measure);

}  // namespace splinecast::apps
