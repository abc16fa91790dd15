#pragma once

#include <cstddef>

#include "core/simd/lanes.hpp"

/// The formulas of a cubic between two knots, for one dimension or several at once.
namespace splinecast::core {

/// Slope of the chord from one position to another that is h seconds later.
template <typename Lane>
[[nodiscard, gnu::always_inline]] inline Lane chord_slope(Lane from, Lane to, double h) noexcept {
  return (to - from) / h;
}

/// Writes cubics of the same length.
class CubicWriter {
 public:
  [[gnu::always_inline]] CubicWriter(double h, std::size_t dimensions,
                                     double* coefficients) noexcept
      : per_h_(1 / h), per_h2_(per_h_ * per_h_), dimensions_(dimensions), c_(coefficients) {}

  /// Writes the coefficients, [power][dimension], of the dimensions from `first` on, from position
  /// x and velocity v0 at the left end, velocity v1 at the right end and chord slope m. Returns the
  /// sums of their magnitudes.
  template <typename Lane>
  [[nodiscard, gnu::always_inline]] Lane write(std::size_t first, Lane x, Lane m, Lane v0,
                                               Lane v1) const noexcept {
    const Lane c2 = (3.0 * m - 2.0 * v0 - v1) * per_h_;
    const Lane c3 = (v0 + v1 - 2.0 * m) * per_h2_;
    store_lane(c_ + first, x);
    store_lane(c_ + dimensions_ + first, v0);
    store_lane(c_ + 2 * dimensions_ + first, c2);
    store_lane(c_ + 3 * dimensions_ + first, c3);
    return without_sign(x) + without_sign(v0) + (without_sign(c2) + without_sign(c3));
  }

 private:
  double per_h_;
  double per_h2_;
  std::size_t dimensions_;
  double* c_;
};

}  // namespace splinecast::core
