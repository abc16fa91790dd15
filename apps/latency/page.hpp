#pragma once

#include "apps/latency/run.hpp"
#include "apps/output/stream.hpp"

namespace splinecast::apps {

/// Writes the result as one self-contained HTML file: the table, the percentile curves of all
/// series, and the histogram over time of each stage. Throws as Output does.
void write_latency_page(const LatencyResult& result, Output& output);

}  // namespace splinecast::apps
