#pragma once

namespace splinecast::core {

/// What `back_substitute` does to one dimension or several: g − γ v_after.
template <typename Lane>
[[nodiscard, gnu::always_inline]] inline Lane back_substituted(double gamma, Lane g,
                                                               Lane v_after) noexcept {
  return gamma == 0 ? g : g - gamma * v_after;  // −0 would else depend on the sign of v_after
}

}  // namespace splinecast::core
