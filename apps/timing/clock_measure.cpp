#include "apps/timing/clock_measure.hpp"

#include <algorithm>
#include <array>
#include <ctime>
#include <limits>

#include "splinecast/clock.hpp"

namespace splinecast::apps {

ClockMeasure measure_clock() {
  constexpr std::size_t kBatches = 201;
  constexpr int kReadings = 200;
  const MonotonicClock clock;
  std::array<double, kBatches> costs{};
  Time least = Time::max();
  for (double& cost : costs) {
    const Time first = clock.now();
    Time last = first;
    for (int i = 0; i < kReadings; ++i) {
      const Time now = clock.now();
      if (now > last) least = std::min(least, now - last);
      last = now;
    }
    cost = static_cast<double>((last - first).count()) / kReadings;
  }
  std::ranges::nth_element(costs, costs.begin() + kBatches / 2);
  timespec claimed{};
  clock_getres(CLOCK_MONOTONIC, &claimed);
  return {.cost_ns = costs[kBatches / 2],
          .resolution_ns = static_cast<double>(least.count()),
          .claimed_ns = static_cast<double>(claimed.tv_nsec)};
}

nlohmann::ordered_json to_json(const ClockMeasure& measure) {
  return {{"cost_ns", measure.cost_ns},
          {"resolution_ns", measure.resolution_ns},
          {"claimed_resolution_ns", measure.claimed_ns}};
}

}  // namespace splinecast::apps
