#include "core/laws/motion.hpp"

#include <cstddef>

#include "core/simd/clones.hpp"

namespace splinecast::core {

SPLINECAST_VECTOR_CLONES
void follow(const LawRates& law, const StateRef& state) noexcept {
  const ChainRule rule(law);
  double* const v = state.velocity.data();
  double* const a = state.acceleration.data();
  double* const j = state.jerk.data();
  const std::size_t dimensions = state.velocity.size();
  for (std::size_t d = 0; d < dimensions; ++d) {
    rule.apply(v[d], a[d], j[d]);
  }
}

}  // namespace splinecast::core
