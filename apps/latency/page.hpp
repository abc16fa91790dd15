#pragma once

#include "apps/latency/run.hpp"
#include "apps/output/stream.hpp"

namespace splinecast::apps {

/// Writes the result as one HTML file that needs nothing else: the table, the percentile curves of
/// all series, and of each stage the histogram over time. Throws as Output does.
void write_latency_page(const LatencyResult& result, Output& output);

}  // namespace splinecast::apps
