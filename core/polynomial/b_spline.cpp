#include "splinecast/b_spline.hpp"

#include <algorithm>
#include <array>
#include <span>
#include <stdexcept>

#include "core/basics/binomial.hpp"
#include "core/polynomial/continuity.hpp"
#include "splinecast/calculus.hpp"

namespace splinecast {
namespace {

/// The knots of a B-spline while it is built, and the segment on the right of each.
struct KnotVector {
  std::vector<Time> knots;
  std::vector<std::size_t> segments;

  void push(Time knot, std::size_t segment, int multiplicity) {
    knots.insert(knots.end(), static_cast<std::size_t>(multiplicity), knot);
    segments.insert(segments.end(), static_cast<std::size_t>(multiplicity), segment);
  }
};

KnotVector knots_of(const PiecewisePolynomial& curve, int degree) {
  KnotVector result;
  const Time origin = curve.breaks().front();
  result.push(Time(0), 0, degree + 1);
  for (std::size_t i = 1; i < curve.segments(); ++i) {
    const int smooth = std::min(core::continuity(curve, i), degree - 1);
    result.push(curve.left_of(i) - origin, i, degree - smooth);
  }
  result.push(curve.breaks().back() - origin, curve.segments(), degree + 1);
  return result;
}

/// The first knot of the longest interval among knots first … last; `last` if all are equal.
std::size_t longest_interval(const std::vector<Time>& knots, std::size_t first, std::size_t last) {
  std::size_t longest = last;
  Time length(0);
  for (std::size_t j = first; j < last; ++j) {
    if (knots[j + 1] - knots[j] <= length) continue;
    length = knots[j + 1] - knots[j];
    longest = j;
  }
  return longest;
}

/// The interval whose polynomial gives control point i. All intervals between knots i + 1 … i +
/// degree give the same blossom. The longest one gives the smallest rounding error: the polynomial
/// of a short interval would be extrapolated over longer neighbours, and the error grows with the
/// degree-th power of the ratio of the lengths. If these knots coincide, any interval next to them
/// gives the same point; at a jump of the position, the interval must be within the support.
std::size_t interval_for(const std::vector<Time>& knots, std::size_t i, std::size_t degree) {
  const std::size_t inner = longest_interval(knots, i + 1, i + degree);
  return inner < i + degree ? inner : longest_interval(knots, i, i + degree + 1);
}

/// Elementary symmetric polynomials of the arguments: e_0 … e_n.
std::array<double, kMaxPolynomialOrder> symmetric(std::span<const double> arguments) noexcept {
  std::array<double, kMaxPolynomialOrder> e{1};
  for (std::size_t m = 0; m < arguments.size(); ++m) {
    for (std::size_t k = m + 1; k > 0; --k) e[k] += arguments[m] * e[k - 1];
  }
  return e;
}

/// The blossom (polar form) of a polynomial Σ c_k u^k of degree n: Σ c_k e_k / C(n, k).
void append_blossom(std::span<const double> c, std::span<const double> arguments,
                    std::size_t dimensions, std::vector<double>& out) {
  const auto e = symmetric(arguments);
  for (std::size_t d = 0; d < dimensions; ++d) {
    double sum = 0;
    for (std::size_t k = arguments.size() + 1; k-- > 0;) {
      sum += c[k * dimensions + d] * (e[k] / core::binomial(arguments.size(), k));
    }
    out.push_back(sum);
  }
}

}  // namespace

BSpline to_b_spline(const PiecewisePolynomial& curve) {
  if (curve.segments() == 0 || curve.is_hold()) {
    throw std::invalid_argument("a B-spline needs at least one segment of positive length");
  }
  const int degree = curve.order() - 1;
  const PiecewisePolynomial even = raised(curve, curve.order());
  auto [knots, segments] = knots_of(even, degree);
  BSpline spline{.degree = degree,
                 .dimensions = curve.dimensions(),
                 .origin = curve.breaks().front(),
                 .knots = std::move(knots),
                 .control_points = {}};
  const auto size = static_cast<std::size_t>(degree);
  std::vector<double> arguments(size);
  for (std::size_t i = 0; i + size + 1 < spline.knots.size(); ++i) {
    const std::size_t segment = segments[interval_for(spline.knots, i, size)];
    const Time left = even.left_of(segment) - spline.origin;
    for (std::size_t k = 0; k < size; ++k) {
      arguments[k] = to_seconds(spline.knots[i + 1 + k] - left);
    }
    append_blossom(even.coefficients(segment), arguments, curve.dimensions(),
                   spline.control_points);
  }
  return spline;
}

}  // namespace splinecast
