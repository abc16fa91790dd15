#pragma once

#include <vector>

#include "apps/sample/options.hpp"

namespace splinecast::apps {

/// Samples a stream in shared memory, at `times` or at a rate, and writes CSV. Attaches again if
/// the stream is recreated. Returns the exit code; throws Interrupted at a signal.
int sample_stream(const SampleOptions& options, std::vector<Time> times);

}  // namespace splinecast::apps
