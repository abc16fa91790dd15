#pragma once

#include <string>

#include "splinecast/reader.hpp"
#include "splinecast/time.hpp"

namespace splinecast::apps {

/// Attaches a reader to a stream; waits up to `wait` until the stream exists. Throws what Reader
/// throws, and Interrupted if a stop is requested first.
[[nodiscard]] Reader attach_reader(const std::string& stream, Time wait, const Trust& trust = {});

}  // namespace splinecast::apps
