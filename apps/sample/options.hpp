#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "apps/files/numbers.hpp"
#include "splinecast/options.hpp"
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

}  // namespace splinecast::apps
