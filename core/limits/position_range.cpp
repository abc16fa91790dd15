#include "core/limits/position_range.hpp"

#include <algorithm>

namespace splinecast::core {

void PositionRange::restart(std::span<const double> position) noexcept {
  std::ranges::copy(position, least_.begin());
  std::ranges::copy(position, greatest_.begin());
}

void PositionRange::add(const SegmentPart& part) noexcept {
  for (std::size_t d = 0; d < least_.size(); ++d) {
    const SegmentRange range =
        range_of(part.order, part.coefficients, part.dimensions, d, 0, part.from, part.to);
    least_[d] = std::min(least_[d], range.least.value);
    greatest_[d] = std::max(greatest_[d], range.greatest.value);
  }
}

}  // namespace splinecast::core
