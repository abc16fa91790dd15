#pragma once

#include <span>

namespace splinecast::core {

/// The sum of the magnitudes of the values: at least the largest magnitude, and NaN if a value is
/// NaN. For a quick test that all values are within a very large bound. O(n).
[[nodiscard]] double magnitude_of(std::span<const double> values) noexcept;

}  // namespace splinecast::core
