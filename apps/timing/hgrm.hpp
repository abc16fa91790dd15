#pragma once

#include <functional>
#include <string>

#include "apps/timing/histogram.hpp"

namespace splinecast::apps {

/// One step along the percentiles of a histogram.
struct PercentileStep {
  Time value{};             ///< end of the cell that reaches the level
  double level = 0;         ///< requested level in percent; 100 at the last step
  std::uint64_t up_to = 0;  ///< number of times up to the value
};

/// Visits the percentiles as HdrHistogram does: five steps per halving of the distance to 100 %.
void for_each_percentile(const Histogram& histogram,
                         const std::function<void(const PercentileStep&)>& visit);

/// The percentile text of HdrHistogram in microseconds, for its plotters: the same bytes as from
/// `outputPercentileDistribution(out, 5, 1000.0)` of its Java library.
[[nodiscard]] std::string percentile_text(const Histogram& histogram);

}  // namespace splinecast::apps
