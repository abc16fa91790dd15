#include "core/basics/magnitude.hpp"

#include "core/simd/clones.hpp"
#include "core/simd/lanes.hpp"

namespace splinecast::core {

SPLINECAST_VECTOR_CLONES
double magnitude_of(std::span<const double> values) noexcept {
  const double* const from = values.data();
  const std::size_t size = values.size();
  FourLanes sums{};
  std::size_t i = 0;
  for (; i + 4 <= size; i += 4) sums += without_sign(load_lane<FourLanes>(from + i));
  if (i < size) sums += without_sign(load_first_of_lane<FourLanes>(from + i, size - i));
  return sum_of_lane(sums);
}

}  // namespace splinecast::core
