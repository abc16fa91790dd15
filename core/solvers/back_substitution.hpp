#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "core/simd/lanes.hpp"
#include "core/solvers/knot_ring.hpp"

namespace splinecast::core {

/// The formula of `back_substitute` for one dimension or several: g − γ v_after.
template <typename Lane>
[[nodiscard, gnu::always_inline]] inline Lane back_substituted(double gamma, Lane g,
                                                               Lane v_after) noexcept {
  return gamma == 0 ? g : g - gamma * v_after;  // otherwise v_after could change the sign of a zero
}

/// The rows of a ring from the one before the newest down to a last one: at most two contiguous
/// blocks of memory.
class OlderRows {
 public:
  OlderRows(KnotRing& knots, std::size_t last) noexcept
      : gamma_(knots.array_of_gamma()),
        g_(knots.array(KnotRing::kG)),
        velocity_(knots.array(KnotRing::kVelocity)),
        stride_(knots.stride()) {
    const std::size_t rows = knots.newest() - last;
    if (rows == 0) return;
    const std::size_t contiguous = knots.contiguous(knots.newest() - 1);
    const std::size_t first = std::min(rows, contiguous);
    runs_ = {{{.end = contiguous, .rows = first}, {.end = knots.slots(), .rows = rows - first}}};
  }

  /// Back-substitutes the velocities of some padded dimensions, from `first` on, into these rows;
  /// `v` are those of the newest knot. Passes through all rows at once, so that the velocity of the
  /// next knot stays in a register. With `kRegular`, no γ may be 0.
  template <bool kRegular, typename Lane, std::size_t kGroups>
  [[gnu::always_inline]] void solve(std::size_t first, std::array<Lane, kGroups> v) const noexcept {
    for (const Run& run : runs_) {
      std::size_t at = run.end * stride_ + first;
      for (std::size_t row = run.end; row > run.end - run.rows;) {
        const double gamma = gamma_[--row];
        at -= stride_;
        for (std::size_t k = 0; k < kGroups; ++k) {
          const auto g = load_lane<Lane>(g_ + at + k * kWidth<Lane>);
          v[k] = kRegular ? g - gamma * v[k] : back_substituted(gamma, g, v[k]);
          store_lane<Lane>(velocity_ + at + k * kWidth<Lane>, v[k]);
        }
      }
    }
  }

 private:
  struct Run {
    std::size_t end = 0;  ///< slot of the ring after its newest row
    std::size_t rows = 0;
  };

  const double* gamma_;
  const double* g_;
  double* velocity_;
  std::size_t stride_;
  std::array<Run, 2> runs_{};
};

}  // namespace splinecast::core
