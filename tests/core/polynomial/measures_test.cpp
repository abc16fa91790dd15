#include "splinecast/calculus.hpp"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "splinecast/calculus.hpp"
#include "tests/fixtures/curves/generators.hpp"

namespace splinecast::core {
namespace {

using testing::largest;
using testing::random_curve;
using testing::random_mesh;
using testing::times_of;

constexpr Time kSecond{1'000'000'000};

/// One-sided values of a derivative at a time, from both adjacent segments.
std::vector<double> one_sided(const PiecewisePolynomial& curve, Time t, std::size_t d, int r) {
  std::vector<double> value(curve.dimensions());
  std::vector<double> jump(curve.dimensions());
  curve.derivative(t, r, value);
  std::vector<double> values{value[d]};
  const std::size_t i = curve.segment_at(t);
  if (curve.left_of(i) == t) {
    curve.jump(i, r, jump);
    values.push_back(value[d] - jump[d]);
  }
  return values;
}

TEST(Measures, NoSampleIsBeyondAnExtremumAndEachExtremumIsAttainedAtItsTime) {
  EXPECT_TRUE(rc::check("extremes", [](std::uint64_t seed) {
    const auto curve = random_curve(seed, 2, 1000);
    for (int r = 0; r < 5; ++r) {
      const double rounding = 1e-13 * largest(curve, r);
      for (std::size_t d = 0; d < 2; ++d) {
        const auto [least, greatest] = extremes(curve, d, r);
        for (const Time t : times_of(curve, 50)) {
          for (const double x : one_sided(curve, t, d, r)) {
            RC_ASSERT(x >= least.value - rounding);
            RC_ASSERT(x <= greatest.value + rounding);
          }
        }
        // The time of an extremum is rounded by up to 0.5 ns. Inside a segment the next derivative
        // is 0 there, so the error of the value is of second order; at a break the time is exact.
        const double rounded = rounding + 1e-18 * largest(curve, r + 2);
        for (const Extremum& extremum : {least, greatest}) {
          const auto values = one_sided(curve, extremum.time, d, r);
          RC_ASSERT(std::ranges::any_of(
              values, [&](double x) { return std::abs(x - extremum.value) <= rounded; }));
        }
      }
    }
  }));
}

TEST(Measures, ExtremesIncludeBothSidesOfAJumpAndReportTheEarliestTime) {
  PiecewisePolynomial curve(1);
  curve.append(Time(0), kSecond, 2, std::vector{0.0, 1.0});
  curve.append(kSecond, 2 * kSecond, 2, std::vector{-2.0, 1.0});
  const auto position = extremes(curve, 0, 0);
  EXPECT_EQ(position.greatest.value, 1);
  EXPECT_EQ(position.greatest.time, kSecond);
  EXPECT_EQ(position.least.value, -2);
  EXPECT_EQ(position.least.time, kSecond);
  EXPECT_EQ(extremes(curve, 0, 1).greatest.time, Time(0));
  EXPECT_EQ(extremes_of_segment(curve, 1, 0, 0).greatest.value, -1);
}

TEST(Measures, TheExtremesOfAParabolaAndAHoldAreExact) {
  PiecewisePolynomial curve(1);
  curve.append(Time(0), kSecond, 3, std::vector{1.0, -1.0, 1.0});
  EXPECT_EQ(extremes(curve, 0, 0).least.value, 0.75);
  EXPECT_EQ(extremes(curve, 0, 0).least.time, kSecond / 2);
  EXPECT_EQ(extremes(curve, 0, 9).least.value, 0);
  PiecewisePolynomial hold(1);
  hold.append(Time(5), Time(5), 1, std::vector{3.0});
  EXPECT_EQ(extremes(hold, 0, 0).greatest.value, 3);
  EXPECT_EQ(extremes(hold, 0, 0).greatest.time, Time(5));
}

TEST(Measures, RefuseInvalidArguments) {
  PiecewisePolynomial line(1);
  EXPECT_THROW((void)extremes(line, 0, 0), std::invalid_argument);
  line.append(Time(5), Time(9), 2, std::vector{3.0, 1.0});
  EXPECT_THROW((void)extremes(line, 1, 0), std::invalid_argument);
  EXPECT_THROW((void)extremes(line, 0, -1), std::invalid_argument);
}

}  // namespace
}  // namespace splinecast::core
