#include "splinecast/calculus.hpp"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <algorithm>
#include <stdexcept>
#include <vector>

#include "tests/fixtures/curves/generators.hpp"

namespace splinecast::core {
namespace {

using testing::largest;
using testing::largest_difference;
using testing::random_curve;
using testing::times_of;

bool same_bits(const PiecewisePolynomial& a, const PiecewisePolynomial& b) {
  if (!std::ranges::equal(a.breaks(), b.breaks()) || a.segments() != b.segments()) return false;
  for (std::size_t i = 0; i < a.segments(); ++i) {
    if (!std::ranges::equal(a.coefficients(i), b.coefficients(i))) return false;
  }
  return true;
}

Time between(const PiecewisePolynomial& curve, std::uint64_t seed) {
  const auto times = times_of(curve, 7);
  return times[seed % times.size()];
}

TEST(Calculus, DerivativesOfTheDerivativeAreTheHigherDerivativesOfTheCurve) {
  EXPECT_TRUE(rc::check("derivatives", [](std::uint64_t seed) {
    const auto curve = random_curve(seed, 2, 1000);
    const auto slope = differentiated(curve);
    std::vector<double> wanted(2);
    std::vector<double> got(2);
    for (const int r : {0, 1, 2, 3, 4}) {
      const double scale = largest(curve, r + 1);
      for (const Time t : times_of(curve, 5)) {
        curve.derivative(t, r + 1, wanted);
        slope.derivative(t, r, got);
        for (std::size_t d = 0; d < 2; ++d) {
          RC_ASSERT(std::abs(wanted[d] - got[d]) <= 1e-12 * scale);
        }
      }
    }
  }));
}

TEST(Calculus, TheIntegralIsContinuousStartsAtZeroAndHasTheCurveAsItsDerivative) {
  EXPECT_TRUE(rc::check("integrals", [](std::uint64_t seed) {
    const auto curve = random_curve(seed, 2, 1000);
    const auto area = integrated(curve);
    RC_ASSERT(area.coefficients(0)[0] == 0);
    for (int r = 0; r < 4; ++r) {
      RC_ASSERT(largest_difference(differentiated(area), curve, r) <= 1e-12 * largest(curve, r));
    }
    const double scale = largest(area, 0);
    std::vector<double> jump(2);
    for (std::size_t i = 0; i < area.segments(); ++i) {
      area.jump(i, 0, jump);
      for (const double x : jump) RC_ASSERT(std::abs(x) <= 1e-14 * scale);
    }
  }));
}

TEST(Calculus, TheIntegralOfAConstantIsItsArea) {
  PiecewisePolynomial curve(1);
  curve.append(Time(0), Time(1'000'000'000), 1, std::vector{2.0});
  curve.append(Time(1'000'000'000), Time(3'000'000'000), 1, std::vector{-3.0});
  const auto area = integrated(curve);
  std::vector<double> value(1);
  for (const auto& [t, wanted] : std::vector<std::pair<int, double>>{{0, 0}, {1, 2}, {3, -4}}) {
    area.derivative(std::chrono::seconds(t), 0, value);
    EXPECT_EQ(value[0], wanted);
  }
}

TEST(Calculus, APartHasTheValuesOfTheWholeAndKeepsTheBitsOfUncutSegments) {
  EXPECT_TRUE(rc::check("restriction", [](std::uint64_t seed) {
    const auto curve = random_curve(seed, 2, 1000);
    Time from = between(curve, seed / 7);
    Time to = between(curve, seed / 11);
    if (to < from) std::swap(from, to);
    if (from == to) return;
    const auto part = restricted(curve, from, to);
    RC_ASSERT(part.breaks().front() == from);
    RC_ASSERT(part.breaks().back() == to);
    // At `to` the part evaluates the segment on the left, the curve the one on the right.
    const auto whole = restricted(curve, curve.breaks().front(), to);
    for (int r = 0; r < 4; ++r) {
      RC_ASSERT(largest_difference(part, whole, r) <= 1e-12 * largest(curve, r));
    }
    const std::size_t first = curve.segment_at(from);
    for (std::size_t i = from == curve.left_of(first) ? 0 : 1; i < part.segments(); ++i) {
      RC_ASSERT(std::ranges::equal(part.coefficients(i), curve.coefficients(first + i)));
    }
  }));
}

TEST(Calculus, RaisingChangesNoBitOfAnyValue) {
  EXPECT_TRUE(rc::check("raised", [](std::uint64_t seed) {
    const auto curve = random_curve(seed, 2, 1000);
    const auto high = raised(curve, kMaxPolynomialOrder);
    RC_ASSERT(high.order_of(0) == kMaxPolynomialOrder);
    std::vector<double> wanted(2);
    std::vector<double> got(2);
    for (const Time t : times_of(curve, 5)) {
      for (int r = 0; r < 5; ++r) {
        curve.derivative(t, r, wanted);
        high.derivative(t, r, got);
        RC_ASSERT(wanted == got);
      }
    }
  }));
}

TEST(Calculus, EveryOperationAcceptsAHold) {
  PiecewisePolynomial hold(1);
  hold.append(Time(5), Time(5), 1, std::vector{3.0});
  EXPECT_TRUE(same_bits(restricted(hold, Time(5), Time(5)), hold));
  EXPECT_EQ(differentiated(hold).coefficients(0)[0], 0);
  EXPECT_EQ(integrated(hold).coefficients(0)[0], 0);
  PiecewisePolynomial line(1);
  line.append(Time(5), Time(9), 2, std::vector{3.0, 1.0});
  EXPECT_TRUE(restricted(line, Time(7), Time(7)).is_hold());
}

TEST(Calculus, ErrorsNameTheRefusedTimesAndOrders) {
  PiecewisePolynomial line(1);
  line.append(Time(5), Time(9), 2, std::vector{3.0, 1.0});
  const auto message = [](const auto& call) -> std::string {
    try {
      (void)call();
    } catch (const std::invalid_argument& e) {
      return e.what();
    }
    return "nothing";
  };
  EXPECT_EQ(message([&] { return restricted(line, Time(4), Time(8)); }),
            "no part from 4 ns to 8 ns of a curve from 5 ns to 9 ns");
  EXPECT_EQ(message([&] { return restricted(line, Time(8), Time(6)); }),
            "no part from 8 ns to 6 ns of a curve from 5 ns to 9 ns");
  EXPECT_EQ(message([&] { return raised(line, 1); }),
            "segment 0 of order 2 cannot be raised to order 1");
  EXPECT_EQ(message([&] { return integrated(raised(line, 16)); }),
            "segment 0: order must be 1 to 16, not 17");
}

}  // namespace
}  // namespace splinecast::core
