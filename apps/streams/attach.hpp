#pragma once

#include <string>

#include "splinecast/reader.hpp"
#include "splinecast/time.hpp"

namespace splinecast::apps {

/// A reader of a stream, which is waited for as long as `wait`. Throws what Reader throws, and
/// Interrupted when a stop is requested before the stream exists.
[[nodiscard]] Reader attach_reader(const std::string& stream, Time wait, const Trust& trust = {});

}  // namespace splinecast::apps
