#pragma once

#include <cstddef>

namespace splinecast::core {

/// n over k, exact for n < 50. Internal.
[[nodiscard]] constexpr double binomial(std::size_t n, std::size_t k) noexcept {
  double result = 1;
  for (std::size_t i = 1; i <= k; ++i) {
    result = result * static_cast<double>(n - k + i) / static_cast<double>(i);
  }
  return result;
}

}  // namespace splinecast::core
