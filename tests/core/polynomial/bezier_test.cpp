#include "splinecast/bezier.hpp"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/polynomial/segment.hpp"
#include "tests/fixtures/curves/generators.hpp"

namespace splinecast::core {
namespace {

using testing::largest;
using testing::random_curve;
using testing::relative_bound;

/// The r-th derivative of one dimension at a fraction of a segment, by de Casteljau's algorithm.
double value_of(const BezierSegment& segment, std::size_t d, int r, double fraction) {
  const std::size_t dimensions =
      segment.control_points.size() / static_cast<std::size_t>(segment.order);
  if (r >= segment.order) return 0;
  std::vector<double> b;
  for (std::size_t i = d; i < segment.control_points.size(); i += dimensions) {
    b.push_back(segment.control_points[i]);
  }
  const double h = to_seconds(segment.right - segment.left);
  for (int left = r; left > 0; --left) {
    const double factor = static_cast<double>(b.size() - 1) / h;
    for (std::size_t i = 0; i + 1 < b.size(); ++i) b[i] = factor * (b[i + 1] - b[i]);
    b.pop_back();
  }
  for (; b.size() > 1; b.pop_back()) {
    for (std::size_t i = 0; i + 1 < b.size(); ++i) b[i] += fraction * (b[i + 1] - b[i]);
  }
  return b[0];
}

TEST(Bezier, TheControlPointsGiveTheCurveAndItsDerivatives) {
  EXPECT_TRUE(rc::check("values", [](std::uint64_t seed) {
    const double ratio = seed % 3 == 0 ? 1000 : 30;
    const auto curve = random_curve(seed, 3, ratio);
    const auto segments = to_bezier(curve);
    RC_ASSERT(segments.size() == curve.segments());
    std::vector<double> wanted(3);
    for (int r = 0; r < 4; ++r) {
      const double bound = relative_bound(ratio, r) * largest(curve, r);
      for (std::size_t i = 0; i < segments.size(); ++i) {
        RC_ASSERT(segments[i].left == curve.left_of(i));
        RC_ASSERT(segments[i].right == curve.right_of(i));
        RC_ASSERT(segments[i].order == curve.order_of(i));
        for (const double fraction : {0.0, 0.25, 0.6, 1.0}) {
          evaluate_derivative(curve.order_of(i), curve.coefficients(i), fraction * curve.seconds(i),
                              r, wanted);
          for (std::size_t d = 0; d < 3; ++d) {
            RC_ASSERT(std::abs(value_of(segments[i], d, r, fraction) - wanted[d]) <= bound);
          }
        }
      }
    }
  }));
}

TEST(Bezier, TheEndPointsAreOnTheCurveAndTheCurveIsInTheConvexHull) {
  EXPECT_TRUE(rc::check("hull", [](std::uint64_t seed) {
    const auto curve = random_curve(seed, 1, 100);
    const double rounding = 1e-13 * largest(curve, 0);
    std::vector<double> value(1);
    const auto segments = to_bezier(curve);
    for (std::size_t i = 0; i < segments.size(); ++i) {
      const auto& points = segments[i].control_points;
      RC_ASSERT(points.size() == static_cast<std::size_t>(curve.order_of(i)));
      RC_ASSERT(points.front() == curve.coefficients(i)[0]);
      evaluate_derivative(curve.order_of(i), curve.coefficients(i), curve.seconds(i), 0, value);
      RC_ASSERT(std::abs(points.back() - value[0]) <= rounding);
      const auto [low, high] = std::ranges::minmax(points);
      for (int k = 0; k <= 20; ++k) {
        evaluate_derivative(curve.order_of(i), curve.coefficients(i), curve.seconds(i) * k / 20, 0,
                            value);
        RC_ASSERT(value[0] >= low - rounding);
        RC_ASSERT(value[0] <= high + rounding);
      }
    }
  }));
}

TEST(Bezier, TheInnerControlPointsOfACubicAreAThirdOfTheSlopesFromItsEnds) {
  PiecewisePolynomial curve(1);  // 1 + 3u at the left end, slope 3 + 12u + 12u² in 2 s
  curve.append(Time(0), Time(2'000'000'000), 4, std::vector{1.0, 3.0, 6.0, 4.0});
  const auto points = to_bezier(curve)[0].control_points;
  EXPECT_EQ(points, (std::vector<double>{1, 3, 13, 63}));
}

TEST(Bezier, AllControlPointsOfAHoldAreItsPosition) {
  PiecewisePolynomial hold(2);
  Segment segment(2);
  build_hold(Time(5), Time(5), std::vector{3.0, 4.0}, segment);
  append(segment, hold);
  EXPECT_EQ(to_bezier(hold)[0].control_points, (std::vector<double>{3, 4, 3, 4, 3, 4, 3, 4}));
}

}  // namespace
}  // namespace splinecast::core
