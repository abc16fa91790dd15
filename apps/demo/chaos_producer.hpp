#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "splinecast/time.hpp"

namespace splinecast::apps {

/// Runs a producer that starves its stream, replaces its future and may be killed at any instant:
/// sends a joint motion, which begins at `start`, at 100 Hz until a stop is requested, then brings
/// it to rest and finishes. A producer that takes over after a kill continues the same motion.
/// Returns the counts `sent`, `starved` and `replaced`.
nlohmann::json run_chaos_producer(const std::string& stream, Time start);

}  // namespace splinecast::apps
