#pragma once

#include <string>
#include <vector>

#include "apps/limits/options.hpp"
#include "splinecast/options.hpp"

namespace splinecast::apps {

/// What `solve` is told.
struct SolveOptions {
  std::vector<std::string> wanted{};  ///< streams, and patterns of their names
  SolverOptions solver{};
  LimitOptions limits{};  ///< the given ones are told of; `solver` has them too
  Time sweep{1'000'000};  ///< pause between looks at several streams
  bool quiet = false;
};

/// Solves until a stop is requested (see signals.hpp), which is its normal end. Returns the exit
/// code.
int run_solve(const SolveOptions& options);

}  // namespace splinecast::apps
