#include "splinecast/b_spline.hpp"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <algorithm>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/fixtures/curves/generators.hpp"

namespace splinecast::core {
namespace {

using testing::batch_curve;
using testing::largest;
using testing::largest_difference;
using testing::online_curve;
using testing::random_curve;
using testing::random_mesh;
using testing::relative_bound;

/// How often each knot occurs, in order.
std::vector<int> multiplicities(const BSpline& spline) {
  std::vector<int> result;
  for (std::size_t i = 0; i < spline.knots.size(); ++i) {
    if (i == 0 || spline.knots[i] != spline.knots[i - 1]) result.push_back(0);
    ++result.back();
  }
  return result;
}

/// The multiplicities `ends`, `inner`, …, `inner`, `ends`.
std::vector<int> pattern(int ends, int inner, std::size_t breaks) {
  std::vector<int> result(breaks, inner);
  result.front() = result.back() = ends;
  return result;
}

TEST(BSpline, ARoundTripKeepsTheCurveInEveryDerivative) {
  EXPECT_TRUE(rc::check("round trip", [](std::uint64_t seed) {
    const double ratio = seed % 3 == 0 ? 1000 : 30;
    const auto curve = random_curve(seed, 3, ratio);
    const auto spline = to_b_spline(curve);
    RC_ASSERT(spline.degree == curve.order() - 1);
    RC_ASSERT(spline.control_points.size() ==
              3 * (spline.knots.size() - static_cast<std::size_t>(curve.order())));
    const auto back = from_b_spline(spline);
    RC_ASSERT(std::ranges::equal(back.breaks(), curve.breaks()));
    for (int r = 0; r < 4; ++r) {
      const double bound = relative_bound(ratio, r);
      RC_ASSERT(largest_difference(curve, back, r) <= bound * largest(curve, r));
    }
  }));
}

TEST(BSpline, KnotsOfC2CubicsAreSimpleAndThoseOfC2QuinticsTriple) {
  const auto mesh = random_mesh(9, 40, 2, 1000);
  const auto cubic = to_b_spline(batch_curve(mesh, false));
  EXPECT_EQ(multiplicities(cubic), pattern(4, 1, 40));
  EXPECT_EQ(cubic.control_points.size(), 2 * (40U + 2));
  EXPECT_EQ(multiplicities(to_b_spline(batch_curve(mesh, true))), pattern(6, 3, 40));
}

TEST(BSpline, KnotsAtAccelerationStepsAreDoubleInCubicsAndQuadrupleInQuintics) {
  const auto mesh = random_mesh(9, 40, 2, 10);
  const auto cubic = multiplicities(to_b_spline(online_curve(mesh, 2, false)));
  const auto quintic = multiplicities(to_b_spline(online_curve(mesh, 2, true)));
  for (std::size_t i = 1; i + 4 < 40; ++i) {
    EXPECT_EQ(cubic[i], 2) << i;
    EXPECT_EQ(quintic[i], 4) << i;
  }
  EXPECT_EQ(cubic.back(), 4);
}

TEST(BSpline, KnotsWhereTheVelocityOrThePositionJumpsAreTripleOrFull) {
  PiecewisePolynomial curve(2);
  const auto append = [&](int second, std::vector<double> c) {
    curve.append(std::chrono::seconds(second), std::chrono::seconds(second + 1), 4, c);
  };
  append(0, {0, 0, 1, 1, 0, 0, 1, 0});  // ends at (2, 1)
  append(1, {2, 1, 1, 1, 0, 0, 0, 1});  // C⁰: the first velocity jumps; ends at (3, 3)
  append(2, {3, 4, 1, 1, 0, 0, 0, 0});  // the second position jumps
  EXPECT_EQ(multiplicities(to_b_spline(curve)), (std::vector<int>{4, 3, 4, 4}));
  const auto back = from_b_spline(to_b_spline(curve));
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t k = 0; k < 8; ++k) {
      EXPECT_NEAR(back.coefficients(i)[k], curve.coefficients(i)[k], 1e-14);
    }
  }
}

TEST(BSpline, OfLowDegreesHaveAKnotAtEachBreak) {
  PiecewisePolynomial steps(1);
  PiecewisePolynomial polygon(1);
  for (int i = 0; i < 3; ++i) {
    steps.append(Time(10 * i), Time(10 * i + 10), 1, std::vector{1.0 + i});
    polygon.append(Time(10 * i), Time(10 * i + 10), 2, std::vector{1e-8 * i, 1.0});
  }
  EXPECT_EQ(multiplicities(to_b_spline(steps)), (std::vector<int>{1, 1, 1, 1}));
  EXPECT_EQ(to_b_spline(steps).control_points, (std::vector<double>{1, 2, 3}));
  EXPECT_EQ(multiplicities(to_b_spline(polygon)), (std::vector<int>{2, 1, 1, 2}));
  EXPECT_EQ(from_b_spline(to_b_spline(steps)).coefficients(2)[0], 3);
}

TEST(BSpline, TheOriginIsTheFirstBreakAndMovesWithTheCurve) {
  auto mesh = random_mesh(4, 20, 1, 10);
  const auto near = to_b_spline(batch_curve(mesh, false));
  const Time epoch{1'700'000'000'000'000'000};
  for (Time& t : mesh.times) t += epoch;
  const auto far = to_b_spline(batch_curve(mesh, false));
  EXPECT_EQ(far.origin - near.origin, epoch);
  EXPECT_EQ(far.knots, near.knots);
  EXPECT_EQ(far.knots.front(), Time(0));
  EXPECT_EQ(far.control_points, near.control_points);
}

TEST(BSpline, OverUniformKnotsIsTheCardinalBSpline) {
  BSpline spline{
      .degree = 3, .dimensions = 1, .origin = Time(7), .knots = {}, .control_points = {}};
  for (int i = 0; i < 11; ++i) spline.knots.emplace_back(std::chrono::seconds(i));
  spline.control_points = {0, 0, 0, 1, 0, 0, 0};
  const auto curve = from_b_spline(spline);
  EXPECT_EQ(curve.breaks().front(), Time(7) + std::chrono::seconds(3));
  EXPECT_EQ(curve.breaks().back(), Time(7) + std::chrono::seconds(7));
  const std::vector<double> wanted{0, 1.0 / 6, 2.0 / 3, 1.0 / 6};
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(curve.coefficients(i)[0], wanted[i], 1e-15);
}

TEST(BSpline, RefusesAHoldAndInvalidKnotsWithAReason) {
  PiecewisePolynomial hold(1);
  EXPECT_THROW((void)to_b_spline(hold), std::invalid_argument);
  hold.append(Time(5), Time(5), 1, std::vector{3.0});
  EXPECT_THROW((void)to_b_spline(hold), std::invalid_argument);
  const auto message = [](int degree, std::vector<int> knots, std::size_t values) -> std::string {
    BSpline spline{.degree = degree,
                   .dimensions = 1,
                   .origin = Time(0),
                   .knots = {},
                   .control_points = std::vector<double>(values)};
    for (const int knot : knots) spline.knots.emplace_back(knot);
    try {
      (void)from_b_spline(spline);
    } catch (const std::invalid_argument& e) {
      return e.what();
    }
    return "nothing";
  };
  EXPECT_EQ(message(16, {}, 0), "degree must be 0 to 15, not 16");
  EXPECT_EQ(message(-1, {}, 0), "degree must be 0 to 15, not -1");
  EXPECT_EQ(message(1, {0, 0, 1}, 2),
            "3 knots and 2 control point values do not make a B-spline of degree 1 and 1 "
            "dimensions");
  EXPECT_EQ(message(1, {0, 5, 3, 6}, 2), "knot 2, 3 ns, is before 5 ns");
  EXPECT_EQ(message(1, {2, 2, 2, 2}, 2),
            "a B-spline of 4 knots spans no interval of positive length");
  EXPECT_EQ(message(3, {0, 1, 2}, 0),
            "3 knots and 0 control point values do not make a B-spline of degree 3 and 1 "
            "dimensions");
}

}  // namespace
}  // namespace splinecast::core
