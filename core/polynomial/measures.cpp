#include "splinecast/calculus.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <stdexcept>
#include <string>

#include "core/polynomial/roots.hpp"

namespace splinecast {
namespace {

/// A polynomial in s = u/h, 0 ≤ s ≤ 1, so that the magnitude of a coefficient bounds its term.
struct UnitPolynomial {
  std::array<double, kMaxPolynomialOrder> values{};
  std::size_t count = 0;

  [[nodiscard]] std::span<const double> coefficients() const noexcept {
    return std::span(values).first(count);
  }
};

/// One dimension of a derivative of a segment.
UnitPolynomial unit_polynomial(const PiecewisePolynomial& curve, std::size_t segment,
                               std::size_t dimension, int derivative) noexcept {
  UnitPolynomial result;
  const auto c = curve.coefficients(segment);
  const double h = curve.seconds(segment);
  double power_of_h = 1;
  for (int k = derivative; k < curve.order_of(segment); ++k) {
    double factor = power_of_h;
    for (int j = 0; j < derivative; ++j) factor *= k - j;
    const std::size_t at = static_cast<std::size_t>(k) * curve.dimensions() + dimension;
    result.values[result.count++] = factor * c[at];
    power_of_h *= h;
  }
  return result;
}

/// The time at a fraction of a segment.
Time time_at(const PiecewisePolynomial& curve, std::size_t segment, double s) noexcept {
  const Time h = curve.right_of(segment) - curve.left_of(segment);
  return curve.left_of(segment) + Time(std::llround(s * static_cast<double>(h.count())));
}

void require_dimension(const PiecewisePolynomial& curve, std::size_t dimension) {
  if (curve.segments() == 0) throw std::invalid_argument("an empty curve has no measure");
  if (dimension < curve.dimensions()) return;
  throw std::invalid_argument("dimension " + std::to_string(dimension) + " of a curve of " +
                              std::to_string(curve.dimensions()));
}

}  // namespace

Extremes extremes_of_segment(const PiecewisePolynomial& curve, std::size_t segment,
                             std::size_t dimension, int derivative) {
  require_dimension(curve, dimension);
  if (derivative < 0) {
    throw std::invalid_argument("derivative " + std::to_string(derivative) + " is negative");
  }
  const auto p = unit_polynomial(curve, segment, dimension, derivative);
  const Extremum left{curve.left_of(segment), core::value_at(p.coefficients(), 0)};
  Extremes result{.least = left, .greatest = left};
  const auto consider = [&](double s) {
    const Extremum here{time_at(curve, segment, s), core::value_at(p.coefficients(), s)};
    if (here.value < result.least.value) result.least = here;
    if (here.value > result.greatest.value) result.greatest = here;
  };
  const auto slope = unit_polynomial(curve, segment, dimension, derivative + 1);
  for (const double s : core::unit_roots(slope.coefficients())) consider(s);
  consider(1);
  return result;
}

Extremes extremes(const PiecewisePolynomial& curve, std::size_t dimension, int derivative) {
  Extremes result = extremes_of_segment(curve, 0, dimension, derivative);
  for (std::size_t i = 1; i < curve.segments(); ++i) {
    const Extremes next = extremes_of_segment(curve, i, dimension, derivative);
    if (next.least.value < result.least.value) result.least = next.least;
    if (next.greatest.value > result.greatest.value) result.greatest = next.greatest;
  }
  return result;
}

}  // namespace splinecast
