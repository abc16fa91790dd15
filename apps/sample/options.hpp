#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "apps/files/numbers.hpp"
#include "splinecast/options.hpp"
#include "splinecast/state.hpp"
#include "splinecast/time.hpp"

namespace splinecast::apps {

/// The options of `sample`.
struct SampleOptions {
  std::vector<std::string> names;  ///< STREAM, or FILE and STREAM
  std::string at;
  std::optional<TimeUnit> time_unit;
  double rate = 0;        ///< Hz; 0: `at`
  std::size_t count = 0;  ///< with `rate`; 0: to the end of a file
  std::string output;
  Time wait{10'000'000'000};
  Trust trust;
};

/// The time of sample k after the first one, at `rate` Hz.
[[nodiscard]] inline Time period_times(std::size_t k, double rate) {
  return Time(std::llround(static_cast<double>(k) * 1e9 / rate));
}

/// The values of a row without values.
[[nodiscard]] inline State no_values(std::size_t dimensions) {
  State state(dimensions);
  const StateRef all = state.ref();
  for (const auto part : {all.position, all.velocity, all.acceleration, all.jerk}) {
    std::ranges::fill(part, std::numeric_limits<double>::quiet_NaN());
  }
  return state;
}

}  // namespace splinecast::apps
