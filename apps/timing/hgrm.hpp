#pragma once

#include <functional>
#include <string>

#include "apps/timing/histogram.hpp"

namespace splinecast::apps {

/// One step along the percentiles of a histogram.
struct PercentileStep {
  Time value{};             ///< end of the cell that reaches the level
  double level = 0;         ///< percent that were asked for; 100 at the last step
  std::uint64_t up_to = 0;  ///< times that do not exceed the value
};

/// Walks the percentiles as HdrHistogram does: five steps to each half of what is left to 100 %.
void for_each_percentile(const Histogram& histogram,
                         const std::function<void(const PercentileStep&)>& visit);

/// HdrHistogram's percentile text in microseconds, which its plotters read: the same bytes as
/// `outputPercentileDistribution(out, 5, 1000.0)` of its Java library.
[[nodiscard]] std::string percentile_text(const Histogram& histogram);

}  // namespace splinecast::apps
