#pragma once

#include <array>
#include <cstddef>

#include "core/limits/extremes.hpp"
#include "splinecast/dimension_kind.hpp"

/// Upper bounds of a quaternion's angular motion over a part of a curve. Internal.
///
/// With N = |q|² and W = vec(q*⊗q̇), ω = 2W/N. The r-th of ω, α = ω̇ and α̇ is A_r/N^r, where A_r
/// is a vector of polynomials: A₁ = 2W and A_{r+1} = Ȧ_r N − r A_r Ṅ. On an interval both have
/// Bernstein control points a_i and n_i. If all n_i > 0, A_r/N^r is a rational Bézier curve: a
/// weighted mean of the points a_i/n_i, at most as large as the largest |a_i|/n_i. Branch and bound
/// over subintervals lowers this bound to the largest value of the curve.
namespace splinecast::core {

/// A vector of polynomials divided by a polynomial, all with `terms` coefficients in s.
struct RotationQuotient {
  /// The number of coefficients of N³ for a quintic.
  static constexpr std::size_t kMaxTerms = 3 * 2 * (kMaxOrder - 1) + 1;
  using Terms = std::array<double, kMaxTerms>;

  std::array<Terms, 3> numerator{};
  Terms denominator{};
  std::size_t terms = 0;
};

class RotationBounds {
 public:
  RotationBounds(const SegmentPart& part, const QuaternionDimensions& quaternion) noexcept;

  /// An upper bound of the r-th of |ω|, |α| and |α̇|, and the approximate place of the largest
  /// value. Exceeds that value by at most 10⁻⁶ of it. Infinite if the quaternion comes near 0 or is
  /// NaN.
  [[nodiscard]] Extreme bound(int r) const noexcept;

  /// Whether the bound is at most `limit`.
  [[nodiscard]] bool keeps(int r, double limit) const noexcept;

 private:
  [[nodiscard]] RotationQuotient quotient(int r) const noexcept;
  [[nodiscard]] Extreme search(int r, double accepted, double rejected) const noexcept;

  double from_;
  double seconds_;             ///< seconds per unit of s
  double width_;               ///< length of the part in s: 1, or 0 for a part of zero length
  RotationQuotient velocity_;  ///< 2W/N, in s = (u − from)/seconds
};

}  // namespace splinecast::core
