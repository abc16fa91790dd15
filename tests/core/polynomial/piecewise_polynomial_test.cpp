#include "splinecast/piecewise_polynomial.hpp"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/polynomial/segment.hpp"
#include "tests/fixtures/curves/generators.hpp"

namespace splinecast::core {
namespace {

/// A segment of one dimension that is constant at `value`.
Segment constant(std::int64_t left, std::int64_t right, double value) {
  Segment segment(1);
  segment.left = Time(left);
  segment.right = Time(right);
  segment.coefficients[0] = value;
  return segment;
}

TEST(PiecewisePolynomial, AKnotBelongsToTheSegmentOnItsRightAndTheLastToTheOneOnItsLeft) {
  PiecewisePolynomial curve(1);
  append(constant(0, 10, 1), curve);
  append(constant(10, 20, 2), curve);
  State state(1);
  for (const auto& [t, value] :
       std::vector<std::pair<int, double>>{{0, 1}, {9, 1}, {10, 2}, {19, 2}, {20, 2}}) {
    curve.evaluate(Time(t), state.ref());
    EXPECT_EQ(state.position()[0], value) << t;
  }
}

TEST(PiecewisePolynomial, RefusesAGapOtherDimensionsAndAnythingAfterAHold) {
  PiecewisePolynomial curve(1);
  append(constant(0, 10, 1), curve);
  EXPECT_THROW(append(constant(11, 20, 2), curve), std::invalid_argument);
  EXPECT_THROW(append(Segment(2), curve), std::invalid_argument);
  PiecewisePolynomial held(1);
  Segment hold(1);
  build_hold(Time(5), Time(5), std::vector{3.0}, hold);
  append(hold, held);
  EXPECT_EQ(held.breaks().size(), 1U);
  State state(1);
  held.evaluate(Time(5), state.ref());
  EXPECT_EQ(state.position()[0], 3.0);
  EXPECT_THROW(append(constant(5, 20, 2), held), std::invalid_argument);
}

TEST(PiecewisePolynomial, ErrorsNameTheSegmentAndTheRefusedValue) {
  PiecewisePolynomial curve(2);
  curve.append(Time(0), Time(10), 1, std::vector{1.0, 2.0});
  const auto message = [&](int left, int right, int order, std::size_t values) -> std::string {
    try {
      curve.append(Time(left), Time(right), order, std::vector<double>(values));
    } catch (const std::invalid_argument& e) {
      return e.what();
    }
    return "nothing";
  };
  EXPECT_EQ(message(10, 20, 0, 0), "segment 1: order must be 1 to 16, not 0");
  EXPECT_EQ(message(10, 20, 17, 34), "segment 1: order must be 1 to 16, not 17");
  EXPECT_EQ(message(10, 20, 3, 4), "segment 1: 4 coefficients for order 3 and 2 dimensions");
  EXPECT_EQ(message(11, 20, 1, 2), "segment 1 begins at 11 ns, but the curve ends at 10 ns");
  EXPECT_EQ(message(10, 10, 1, 2), "segment 1 ends at 10 ns, not after its start");
  EXPECT_EQ(curve.segments(), 1U);
}

TEST(PiecewisePolynomial, DerivativesUpToTheThirdHaveTheBitsOfEvaluate) {
  EXPECT_TRUE(rc::check("derivatives", [](std::uint64_t seed) {
    const auto curve = testing::random_curve(seed, 3, 1000);
    State state(3);
    std::vector<double> values(3);
    for (const Time t : testing::times_of(curve, 5)) {
      curve.evaluate(t, state.ref());
      for (std::size_t r = 0; r < 4; ++r) {
        curve.derivative(t, static_cast<int>(r), values);
        RC_ASSERT(std::ranges::equal(values, state.values().subspan(3 * r, 3)));
      }
    }
  }));
}

TEST(PiecewisePolynomial, EveryDerivativeOfAPolynomialOfAnyOrderIsItsTaylorSum) {
  for (int order = 1; order <= kMaxPolynomialOrder; ++order) {
    PiecewisePolynomial curve(1);
    const auto c = testing::random_values(7, static_cast<std::size_t>(order));
    curve.append(Time(0), Time(1'000'000'000), order, c);
    std::vector<double> value(1);
    for (int r = 0; r <= order; ++r) {
      double wanted = 0;
      for (int k = r; k < order; ++k) {
        wanted += std::tgamma(k + 1) / std::tgamma(k - r + 1) * c[static_cast<std::size_t>(k)] *
                  std::pow(0.5, k - r);
      }
      curve.derivative(Time(500'000'000), r, value);
      EXPECT_NEAR(value[0], wanted, 1e-13 * std::tgamma(order)) << order << ", " << r;
    }
  }
}

TEST(PiecewisePolynomial, AJumpIsTheRightHandMinusTheLeftHandValue) {
  PiecewisePolynomial curve(1);
  curve.append(Time(0), Time(1'000'000'000), 3, std::vector{1.0, 2.0, 3.0});
  curve.append(Time(1'000'000'000), Time(3'000'000'000), 2, std::vector{7.0, 4.0});
  std::vector<double> jump(1);
  const std::vector<double> wanted{1, -4, -6, 0};
  for (int r = 0; r < 4; ++r) {
    curve.jump(1, r, jump);
    EXPECT_EQ(jump[0], wanted[static_cast<std::size_t>(r)]);
    curve.jump(0, r, jump);
    EXPECT_EQ(jump[0], 0);
  }
}

}  // namespace
}  // namespace splinecast::core
