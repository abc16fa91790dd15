#pragma once

#include <cstdint>
#include <random>
#include <vector>

#include "splinecast/time.hpp"

namespace splinecast::bench {

inline constexpr std::size_t kRandomSegments = 65'536;

/// kRandomSegments random times from 0 to before `end`, the same ones for every caller.
[[nodiscard]] inline std::vector<Time> random_times(Time end) {
  std::mt19937_64 random(1);
  std::vector<Time> times(kRandomSegments);
  for (Time& t : times) {
    t = Time(static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(end.count())));
  }
  return times;
}

}  // namespace splinecast::bench
