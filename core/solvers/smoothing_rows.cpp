#include "core/solvers/smoothing_rows.hpp"

#include <algorithm>
#include <cmath>

namespace splinecast::core {

double smoothing_lag(double lambda, double mean_interval) noexcept {
  const double ratio = lambda / (mean_interval * mean_interval * mean_interval);
  return 13 * std::max(1.0, std::sqrt(std::sqrt(ratio)));
}

}  // namespace splinecast::core
