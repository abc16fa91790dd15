#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "splinecast/piecewise_polynomial.hpp"

/// Real roots of polynomials on the unit interval. Internal.
namespace splinecast::core {

/// Largest number of coefficients.
inline constexpr std::size_t kMaxRootCoefficients = kMaxPolynomialOrder;

/// Roots in ascending order: at most as many as the degree, and the two ends.
struct Roots {
  std::array<double, kMaxRootCoefficients + 1> values{};
  std::size_t count = 0;

  [[nodiscard]] const double* begin() const noexcept { return values.data(); }
  [[nodiscard]] const double* end() const noexcept { return values.data() + count; }
};

/// Σ c_k s^k by Horner's rule.
[[nodiscard]] double value_at(std::span<const double> c, double s) noexcept;

/// The roots of Σ c_k s^k, lowest power first, in 0 ≤ s ≤ 1; none if it is constant. At
/// most kMaxRootCoefficients coefficients. Does not allocate; bounded work, O(degree³).
///
/// The roots of the derivative divide the interval into pieces on which the polynomial is monotone,
/// with at most one root each, between ends of different sign. Up to degree 2 the root has a closed
/// form; above, Newton's steps inside the bracket find it. The closed forms of Cardano and Ferrari
/// would lose digits to cancellation if the leading coefficient is small, as on every nearly
/// straight segment, or if roots are close together; and the quintics of a full stop have none.
[[nodiscard]] Roots unit_roots(std::span<const double> c) noexcept;

}  // namespace splinecast::core
