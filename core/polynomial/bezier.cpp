#include "splinecast/bezier.hpp"

#include <span>

#include "core/basics/binomial.hpp"

namespace splinecast {
namespace {

/// The control points b_j of degree n and length h follow from Δ^k b_0 = c_k h^k / C(n, k) and b_j
/// = Σ C(j, k) Δ^k b_0: by repeated sums.
void scale_to_differences(std::span<double> c, std::size_t dimensions, double h) noexcept {
  const std::size_t degree = c.size() / dimensions - 1;
  double power_of_h = 1;
  for (std::size_t k = 0; k <= degree; ++k) {
    for (std::size_t d = 0; d < dimensions; ++d) {
      c[k * dimensions + d] *= power_of_h / core::binomial(degree, k);
    }
    power_of_h *= h;
  }
}

void differences_to_points(std::span<double> b, std::size_t dimensions) noexcept {
  for (std::size_t first = b.size() - dimensions; first > 0; first -= dimensions) {
    for (std::size_t j = first; j < b.size(); ++j) b[j] += b[j - dimensions];
  }
}

}  // namespace

std::vector<BezierSegment> to_bezier(const PiecewisePolynomial& curve) {
  std::vector<BezierSegment> segments;
  segments.reserve(curve.segments());
  for (std::size_t i = 0; i < curve.segments(); ++i) {
    const auto c = curve.coefficients(i);
    BezierSegment segment{.left = curve.left_of(i),
                          .right = curve.right_of(i),
                          .order = curve.order_of(i),
                          .control_points = {c.begin(), c.end()}};
    scale_to_differences(segment.control_points, curve.dimensions(), curve.seconds(i));
    differences_to_points(segment.control_points, curve.dimensions());
    segments.push_back(std::move(segment));
  }
  return segments;
}

}  // namespace splinecast
