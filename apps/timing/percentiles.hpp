#pragma once

#include <array>
#include <cstdint>

#include "apps/timing/histogram.hpp"

namespace splinecast::apps {

/// The percentiles of the reports, in thousandths of a percent: 50 to 99.999 %.
inline constexpr std::array<std::uint64_t, 6> kPercentiles{50'000, 90'000, 99'000,
                                                           99'900, 99'990, 99'999};

/// With fewer times above it a percentile is not reproducible.
inline constexpr std::uint64_t kEnoughAbove = 10;

struct Percentile {
  double percent = 0;
  Time value{};
  std::uint64_t above = 0;  ///< number of times above it
  [[nodiscard]] bool has_enough() const noexcept { return above >= kEnoughAbove; }
};

/// The time at rank ⌈p·count⌉; the histogram must not be empty.
[[nodiscard]] Percentile percentile_of(const Histogram& histogram, std::uint64_t thousandths);

}  // namespace splinecast::apps
