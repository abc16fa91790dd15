#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "splinecast/time.hpp"

namespace splinecast::apps {

/// Plays a producer that lets its stream run dry, changes its mind and may be killed at any
/// instant: sends a joint motion at 100 Hz until a stop is requested, then brings it to rest and
/// finishes. One that comes after another has been killed goes on with the same motion, which
/// starts at `start`. Returns what it has done.
nlohmann::json run_chaos_producer(const std::string& stream, Time start);

}  // namespace splinecast::apps
