#pragma once

#include <string>
#include <vector>

#include "apps/limits/options.hpp"
#include "splinecast/options.hpp"

namespace splinecast::apps {

/// Options of `solve`.
struct SolveOptions {
  std::vector<std::string> wanted{};  ///< streams, and patterns of stream names
  SolverOptions solver{};
  LimitOptions limits{};  ///< the requested ones, for messages; `solver` has them too
  Time sweep{1'000'000};  ///< pause between sweeps over several streams
  bool quiet = false;
};

/// Solves until a stop is requested (see signals.hpp), which is its normal end. Returns the exit
/// code.
int run_solve(const SolveOptions& options);

}  // namespace splinecast::apps
