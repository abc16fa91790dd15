#pragma once

#include <vector>

#include "apps/sample/options.hpp"

namespace splinecast::apps {

/// Samples the executed curve of a stream in a recording, at `times` or at a rate, and writes CSV
/// with status and kind of segment. Of a stream that follows a law, times are host times if the
/// file has the law, else stream times; says which. Returns the exit code; throws InputError for a
/// file without that curve, Interrupted at a signal.
int sample_recording(const SampleOptions& options, const std::vector<Time>& times);

}  // namespace splinecast::apps
