#include "splinecast/b_spline.hpp"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "tests/fixtures/curves/generators.hpp"

namespace splinecast::core {
namespace {

using testing::batch_curve;
using testing::largest;
using testing::online_curve;
using testing::random_curve;
using testing::random_mesh;
using testing::relative_bound;
using testing::times_of;

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

/// One dimension of a B-spline, to be evaluated without the library.
struct OneDimension {
  int degree;
  std::vector<Time> knots;  ///< relative to the origin
  std::vector<double> points;

  OneDimension(const BSpline& spline, std::size_t d) : degree(spline.degree), knots(spline.knots) {
    for (std::size_t i = d; i < spline.control_points.size(); i += spline.dimensions) {
      points.push_back(spline.control_points[i]);
    }
  }

  /// Seconds from knot i to knot j.
  [[nodiscard]] double between(std::size_t i, std::size_t j) const {
    return to_seconds(knots[j] - knots[i]);
  }

  void differentiate() {
    const auto p = static_cast<std::size_t>(degree);
    for (std::size_t i = 0; i + 1 < points.size(); ++i) {
      const double length = between(i + 1, i + p + 1);
      points[i] = length > 0 ? degree * (points[i + 1] - points[i]) / length : 0;
    }
    points.pop_back();
    knots.pop_back();
    knots.erase(knots.begin());
    --degree;
  }

  /// De Boor's algorithm. A time on a knot belongs to the interval on its right.
  [[nodiscard]] double at(Time t) const {
    const auto p = static_cast<std::size_t>(degree);
    std::size_t j = points.size() - 1;
    while (j > p && (knots[j] > t || knots[j] == knots[j + 1])) --j;
    std::vector<double> b(points.begin() + static_cast<std::ptrdiff_t>(j - p),
                          points.begin() + static_cast<std::ptrdiff_t>(j + 1));
    for (std::size_t k = 1; k <= p; ++k) {
      for (std::size_t i = p; i >= k; --i) {
        const double share = to_seconds(t - knots[j - p + i]) / between(j - p + i, i + 1 + j - k);
        b[i] = b[i - 1] + share * (b[i] - b[i - 1]);
      }
    }
    return b[p];
  }
};

double value_of(const BSpline& spline, std::size_t d, int r, Time t) {
  OneDimension one(spline, d);
  for (int left = std::min(r, one.degree); left > 0; --left) one.differentiate();
  return r > spline.degree ? 0 : one.at(t - spline.origin);
}

TEST(BSpline, GivesTheCurveAndItsDerivatives) {
  EXPECT_TRUE(rc::check("values", [](std::uint64_t seed) {
    const double ratio = seed % 3 == 0 ? 1000 : 30;
    const auto curve = random_curve(seed, 3, ratio);
    const auto spline = to_b_spline(curve);
    RC_ASSERT(spline.degree == curve.order() - 1);
    RC_ASSERT(spline.control_points.size() ==
              3 * (spline.knots.size() - static_cast<std::size_t>(curve.order())));
    std::vector<double> wanted(3);
    for (int r = 0; r < 4; ++r) {
      const double bound = relative_bound(ratio, r) * largest(curve, r);
      for (const Time t : times_of(curve, 3)) {
        curve.derivative(t, r, wanted);
        for (std::size_t d = 0; d < 3; ++d) {
          RC_ASSERT(std::abs(value_of(spline, d, r, t) - wanted[d]) <= bound);
        }
      }
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
  std::vector<double> wanted(2);
  for (const Time t : times_of(curve, 4)) {
    curve.derivative(t, 0, wanted);
    for (std::size_t d = 0; d < 2; ++d) {
      EXPECT_NEAR(value_of(to_b_spline(curve), d, 0, t), wanted[d], 1e-14);
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

TEST(BSpline, RefusesAHold) {
  PiecewisePolynomial hold(1);
  EXPECT_THROW((void)to_b_spline(hold), std::invalid_argument);
  hold.append(Time(5), Time(5), 1, std::vector{3.0});
  EXPECT_THROW((void)to_b_spline(hold), std::invalid_argument);
}

}  // namespace
}  // namespace splinecast::core
