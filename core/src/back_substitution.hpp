#pragma once

#include <algorithm>
#include <cstddef>

namespace splinecast::core {

/// What `back_substitute` does, in line: v = g − γ v_after for n dimensions; v overlaps neither.
inline void back_substitute_row(double gamma, const double* __restrict g,
                                const double* __restrict v_after, double* __restrict v,
                                std::size_t n) noexcept {
  if (gamma == 0) {
    std::copy_n(g, n, v);  // −0 would else depend on the sign of v_after
    return;
  }
  for (std::size_t d = 0; d < n; ++d) v[d] = g[d] - gamma * v_after[d];
}

}  // namespace splinecast::core
