#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "splinecast/time.hpp"

namespace splinecast::apps {

/// Injects faults into a live stream for `duration`: solver and producer are killed and the solver
/// is paused at random instants, and the producer starves the stream and replaces its future, while
/// three readers at 1 kHz, one of them this process, check what they read. Prints a line per second
/// unless `quiet`. Returns the faults, the findings and the recovery times. `sound` is whether
/// nothing stepped, changed or was lost; it is null, and `judged` false, if a stop was requested
/// before that was known. Throws Interrupted if a stop was requested before there is a result.
nlohmann::json run_chaos(const std::string& stream, Time duration, bool quiet);

/// The result of run_chaos as text.
[[nodiscard]] std::string chaos_summary(const nlohmann::json& found);

}  // namespace splinecast::apps
