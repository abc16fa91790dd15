#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "splinecast/time.hpp"

namespace splinecast::apps {

/// Shows a stream that everything happens to: for `duration` its solver and its producer are killed
/// and stopped at random instants and its producer lets it run dry and replaces its future, while
/// three readers at 1 kHz, one of them this process, check what they read. Prints a line a second
/// unless `quiet`. Returns what was done, what was found and how long each took to recover;
/// `sound` is whether nothing stepped, changed or was lost; null, and `judged` false, if a stop was
/// requested before that was known. Throws Interrupted if it came before there is anything to tell.
nlohmann::json run_chaos(const std::string& stream, Time duration, bool quiet);

/// What it found, for a person to read.
[[nodiscard]] std::string chaos_summary(const nlohmann::json& found);

}  // namespace splinecast::apps
