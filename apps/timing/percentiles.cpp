#include "apps/timing/percentiles.hpp"

#include <algorithm>

namespace splinecast::apps {

Percentile percentile_of(const Histogram& histogram, std::uint64_t thousandths) {
  constexpr std::uint64_t kAll = 100'000;
  const std::uint64_t count = histogram.count();
  const std::uint64_t above = std::min(
      count - 1, count / kAll * (kAll - thousandths) + count % kAll * (kAll - thousandths) / kAll);
  return {.percent = static_cast<double>(thousandths) / 1000,
          .value = histogram.at_rank(count - above),
          .above = above};
}

}  // namespace splinecast::apps
