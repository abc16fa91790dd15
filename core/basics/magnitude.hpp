#pragma once

#include <span>

namespace splinecast::core {

/// The sum of the magnitudes of some values: at least the largest of them, and NaN if one of them
/// is NaN. For a quick look whether all of them lie within a bound that is far beyond any of use.
/// O(n).
[[nodiscard]] double magnitude_of(std::span<const double> values) noexcept;

}  // namespace splinecast::core
