#pragma once

#include <functional>

namespace splinecast::apps {

/// Runs what a verb does and turns what it throws into a message and an exit code. Returns the code
/// it returned, or that of the error.
int run_guarded(const std::function<int()>& action);

}  // namespace splinecast::apps
