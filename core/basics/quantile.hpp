#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>

namespace splinecast::core {

/// The value of rank ⌈fraction · count⌉, fraction from 0 to 1; T{} if there are no values. Reorders
/// the values. O(count), allocates nothing.
template <typename T>
[[nodiscard]] T quantile(std::span<T> values, double fraction) noexcept {
  if (values.empty()) return T{};
  const double rank = std::ceil(fraction * static_cast<double>(values.size()));
  const auto at =
      values.begin() + std::max(static_cast<std::ptrdiff_t>(rank) - 1, std::ptrdiff_t{0});
  std::ranges::nth_element(values, at);
  return *at;
}

}  // namespace splinecast::core
