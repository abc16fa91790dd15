#pragma once

#include <string>

#include "splinecast/reader.hpp"
#include "splinecast/time.hpp"

namespace splinecast::apps {

/// A reader of a stream, which is waited for as long as `wait`. Throws what ipc::Reader throws, and
/// Interrupted when a stop is requested before the stream exists.
[[nodiscard]] ipc::Reader attach_reader(const std::string& stream, core::Time wait,
                                        const ipc::Trust& trust = {});

}  // namespace splinecast::apps
