#pragma once

#include <cstdint>
#include <random>
#include <vector>

#include "splinecast/time.hpp"

namespace splinecast::bench {

inline constexpr std::size_t kRandomSegments = 65'536;

/// As many times, the same ones for everybody, from 0 to before `end`.
[[nodiscard]] inline std::vector<core::Time> random_times(core::Time end) {
  std::mt19937_64 random(1);
  std::vector<core::Time> times(kRandomSegments);
  for (core::Time& t : times) {
    t = core::Time(static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(end.count())));
  }
  return times;
}

}  // namespace splinecast::bench
