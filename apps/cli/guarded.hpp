#pragma once

#include <functional>

namespace splinecast::apps {

/// Runs the action of a verb and returns its exit code. Catches an exception, prints its message
/// and returns the exit code of this error.
int run_guarded(const std::function<int()>& action);

}  // namespace splinecast::apps
