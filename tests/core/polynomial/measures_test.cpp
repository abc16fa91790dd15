#include "splinecast/calculus.hpp"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <algorithm>
#include <cmath>
#include <numbers>
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

TEST(Measures, BetweenCrossingsTheCurveStaysOnOneSideAndAtEachCrossingItHasTheValue) {
  EXPECT_TRUE(rc::check("crossings", [](std::uint64_t seed) {
    const auto curve = random_curve(seed, 1, 1000);
    const auto range = extremes(curve, 0, 0);
    const double share = static_cast<double>(1 + seed % 9) / 10;
    const double value = range.least.value + share * (range.greatest.value - range.least.value);
    auto times = crossings(curve, 0, value);
    RC_ASSERT(std::ranges::is_sorted(times));
    RC_ASSERT(seed % 5 == 0 || !times.empty());
    const double near = 1e-12 * largest(curve, 0) + 1e-9 * largest(curve, 1);
    for (const Time t : times) {
      const auto sides = one_sided(curve, t, 0, 0);
      RC_ASSERT(std::ranges::min(sides) - near <= value);
      RC_ASSERT(std::ranges::max(sides) + near >= value);
    }
    times.push_back(curve.breaks().back() + Time(1));
    std::size_t next = 0;
    int side = 0;
    for (const Time t : times_of(curve, 50)) {
      if (t >= times[next]) side = 0;
      while (t >= times[next]) ++next;
      const double x = one_sided(curve, t, 0, 0)[0] - value;
      if (std::abs(x) <= near) continue;
      RC_ASSERT(side == 0 || (x > 0) == (side > 0));
      side = x > 0 ? 1 : -1;
    }
  }));
}

TEST(Measures, ThePositionOfAWaypointIsCrossedOnceAtItsTime) {
  const auto mesh = random_mesh(3, 40, 1, 1000);
  const auto curve = testing::batch_curve(mesh, true);
  for (std::size_t i = 0; i < mesh.size(); ++i) {
    const auto times = crossings(curve, 0, mesh.positions[i]);
    const auto at_knot = [&](Time t) { return std::abs((t - mesh.times[i]).count()) <= 1; };
    EXPECT_EQ(std::ranges::count_if(times, at_knot), 1) << i;
  }
}

TEST(Measures, TouchingJumpingAcrossAndRestingOnAValueAreCrossings) {
  PiecewisePolynomial curve(1);
  curve.append(Time(0), kSecond, 3, std::vector{1.0, -4.0, 4.0});     // touches 0 at 0.5
  curve.append(kSecond, 2 * kSecond, 2, std::vector{-1.0, -1.0});     // jumps from 1 to −1
  curve.append(2 * kSecond, 3 * kSecond, 2, std::vector{-2.0, 2.0});  // ends on 0
  curve.append(3 * kSecond, 4 * kSecond, 1, std::vector{0.0});        // rests on it
  curve.append(4 * kSecond, 5 * kSecond, 4, std::vector{0.0, 0.0, 0.0, 1.0});  // leaves it
  EXPECT_EQ(crossings(curve, 0, 0),
            (std::vector<Time>{kSecond / 2, kSecond, 3 * kSecond, 4 * kSecond}));
  EXPECT_EQ(crossings(curve, 0, 2), std::vector<Time>{});
}

TEST(Measures, InOneDimensionTheArcLengthIsTheTotalVariation) {
  EXPECT_TRUE(rc::check("total variation", [](std::uint64_t seed) {
    const auto curve = random_curve(seed, 1, 1000);
    double variation = 0;
    for (std::size_t i = 0; i < curve.segments(); ++i) {
      const auto part = restricted(curve, curve.left_of(i), curve.right_of(i));
      double before = part.coefficients(0)[0];
      std::vector<double> value(1);
      auto turns = crossings(differentiated(part), 0, 0);
      turns.push_back(part.breaks().back());
      for (const Time t : turns) {
        part.derivative(t, 0, value);
        variation += std::abs(value[0] - before);
        before = value[0];
      }
    }
    // The times of the turning points are rounded to nanoseconds.
    const double rounding = 1e-12 * variation + 1e-16 * largest(curve, 2);
    RC_ASSERT(std::abs(arc_length(curve, curve.breaks().front(), curve.breaks().back()) -
                       variation) <= rounding);
  }));
}

TEST(Measures, TheArcLengthOfAStraightPathIsItsLengthAtAnySpeed) {
  PiecewisePolynomial curve(2);
  // 3/5 and 4/5 of 10 s³ − 15 s⁴ + 6 s⁵: at rest at both ends.
  std::vector<double> c(12);
  for (const auto& [k, x] :
       std::vector<std::pair<std::size_t, double>>{{3, 10}, {4, -15}, {5, 6}}) {
    c[2 * k] = 0.6 * x;
    c[2 * k + 1] = 0.8 * x;
  }
  curve.append(Time(0), kSecond, 6, c);
  EXPECT_NEAR(arc_length(curve, Time(0), kSecond), 1, 1e-14);
  EXPECT_NEAR(arc_length(curve, Time(0), kSecond / 2), 0.5, 1e-14);
  EXPECT_EQ(arc_length(curve, kSecond, kSecond), 0);
}

TEST(Measures, TheArcLengthsOfAParabolaAndOfACuspMatchTheClosedForms) {
  PiecewisePolynomial parabola(2);  // (s, s²)
  parabola.append(Time(0), kSecond, 3, std::vector{0.0, 0.0, 1.0, 0.0, 0.0, 1.0});
  EXPECT_NEAR(arc_length(parabola, Time(0), kSecond), std::sqrt(5.0) / 2 + std::asinh(2.0) / 4,
              1e-13);
  PiecewisePolynomial cusp(2);  // ((s − ½)², (s − ½)³), s = 0 … 1
  cusp.append(Time(0), kSecond, 4, std::vector{0.25, -0.125, -1.0, 0.75, 1.0, -1.5, 0.0, 1.0});
  const double side = (std::pow(4 + 9 * 0.25, 1.5) - 8) / 27;
  EXPECT_NEAR(arc_length(cusp, Time(0), kSecond), 2 * side, 1e-12);
}

TEST(Measures, TheArcLengthThroughPointsOfACircleTendsToItsCircumference) {
  double error = 1;
  for (const std::size_t knots : {9U, 17U, 33U, 65U}) {
    testing::Mesh mesh{.dimensions = 2, .times = {}, .positions = {}};
    for (std::size_t i = 0; i < knots; ++i) {
      const double turn = static_cast<double>(i) / static_cast<double>(knots - 1);
      mesh.times.emplace_back(std::llround(turn * 1e9));
      mesh.positions.push_back(std::cos(2 * std::numbers::pi * turn));
      mesh.positions.push_back(std::sin(2 * std::numbers::pi * turn));
    }
    const auto curve = testing::batch_curve(mesh, false);
    const double length = arc_length(curve, mesh.times.front(), mesh.times.back());
    const double closer = std::abs(length - 2 * std::numbers::pi);
    EXPECT_LT(closer, error / 3);
    error = closer;
  }
}

TEST(Measures, ArcLengthsOfPartsAddUp) {
  EXPECT_TRUE(rc::check("additive", [](std::uint64_t seed) {
    const auto curve = random_curve(seed, 3, 1000);
    const Time first = curve.breaks().front();
    const Time last = curve.breaks().back();
    const double whole = arc_length(curve, first, last);
    const Time middle = first + (last - first) * static_cast<int>(seed % 97) / 97;
    RC_ASSERT(std::abs(arc_length(curve, first, middle) + arc_length(curve, middle, last) -
                       whole) <= 2e-12 * whole);
  }));
}

TEST(Measures, RefuseInvalidArguments) {
  PiecewisePolynomial line(1);
  EXPECT_THROW((void)extremes(line, 0, 0), std::invalid_argument);
  EXPECT_THROW((void)arc_length(line, Time(0), Time(0)), std::invalid_argument);
  line.append(Time(5), Time(9), 2, std::vector{3.0, 1.0});
  EXPECT_THROW((void)extremes(line, 1, 0), std::invalid_argument);
  EXPECT_THROW((void)extremes(line, 0, -1), std::invalid_argument);
  EXPECT_THROW((void)crossings(line, 1, 0), std::invalid_argument);
  EXPECT_THROW((void)arc_length(line, Time(5), Time(10)), std::invalid_argument);
}

}  // namespace
}  // namespace splinecast::core
