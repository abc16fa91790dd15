#include "splinecast/bezier.hpp"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <algorithm>
#include <stdexcept>
#include <vector>

#include "core/polynomial/segment.hpp"
#include "tests/fixtures/curves/generators.hpp"

namespace splinecast::core {
namespace {

using testing::largest;
using testing::largest_difference;
using testing::random_curve;
using testing::relative_bound;

TEST(Bezier, ARoundTripKeepsTheCurveInEveryDerivative) {
  EXPECT_TRUE(rc::check("round trip", [](std::uint64_t seed) {
    const double ratio = seed % 3 == 0 ? 1000 : 30;
    const auto curve = random_curve(seed, 3, ratio);
    const auto back = from_bezier(3, to_bezier(curve));
    RC_ASSERT(std::ranges::equal(back.breaks(), curve.breaks()));
    for (int r = 0; r < 4; ++r) {
      const double bound = relative_bound(ratio, r);
      RC_ASSERT(largest_difference(curve, back, r) <= bound * largest(curve, r));
    }
    for (std::size_t i = 0; i < curve.segments(); ++i) {
      RC_ASSERT(back.order_of(i) == curve.order_of(i));
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

TEST(Bezier, AHoldStaysAHoldAndAWrongNumberOfPointsIsRefused) {
  PiecewisePolynomial hold(2);
  Segment segment(2);
  build_hold(Time(5), Time(5), std::vector{3.0, 4.0}, segment);
  append(segment, hold);
  const auto segments = to_bezier(hold);
  EXPECT_EQ(segments[0].control_points, (std::vector<double>{3, 4, 3, 4, 3, 4, 3, 4}));
  const auto back = from_bezier(2, segments);
  EXPECT_TRUE(back.is_hold());
  EXPECT_TRUE(std::ranges::equal(back.coefficients(0), hold.coefficients(0)));
  for (const std::size_t values : {0U, 1U, 7U, 9U}) {
    const BezierSegment wrong{Time(0), Time(1), 4, std::vector<double>(values)};
    EXPECT_THROW((void)from_bezier(2, std::vector{wrong}), std::invalid_argument) << values;
  }
}

}  // namespace
}  // namespace splinecast::core
