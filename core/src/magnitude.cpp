#include "splinecast/core/magnitude.hpp"

#include <limits>

#include "dimension_lanes.hpp"
#include "vector_clones.hpp"

namespace splinecast::core {
namespace {

[[gnu::always_inline]] inline FourLanes without_sign(FourLanes values) noexcept {
  using Bits [[gnu::vector_size(sizeof(FourLanes))]] = long long;
  constexpr long long kRest = std::numeric_limits<long long>::max();
  return reinterpret_cast<FourLanes>(reinterpret_cast<Bits>(values) &
                                     Bits{kRest, kRest, kRest, kRest});
}

}  // namespace

SPLINECAST_VECTOR_CLONES
double magnitude_of(std::span<const double> values) noexcept {
  const double* const from = values.data();
  const std::size_t size = values.size();
  FourLanes sums{};
  std::size_t i = 0;
  for (; i + 4 <= size; i += 4) sums += without_sign(load_lane<FourLanes>(from + i));
  if (i < size) sums += without_sign(load_first_of_lane<FourLanes>(from + i, size - i));
  return sums[0] + sums[1] + (sums[2] + sums[3]);
}

}  // namespace splinecast::core
