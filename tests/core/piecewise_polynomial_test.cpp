#include "splinecast/core/piecewise_polynomial.hpp"

#include <gtest/gtest.h>

#include <stdexcept>
#include <vector>

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
  curve.append(constant(0, 10, 1));
  curve.append(constant(10, 20, 2));
  State state(1);
  for (const auto& [t, value] :
       std::vector<std::pair<int, double>>{{0, 1}, {9, 1}, {10, 2}, {19, 2}, {20, 2}}) {
    curve.evaluate(Time(t), state.ref());
    EXPECT_EQ(state.position()[0], value) << t;
  }
}

TEST(PiecewisePolynomial, RefusesAGapOtherDimensionsAndAnythingBehindAHold) {
  PiecewisePolynomial curve(1);
  curve.append(constant(0, 10, 1));
  EXPECT_THROW(curve.append(constant(11, 20, 2)), std::invalid_argument);
  EXPECT_THROW(curve.append(Segment(2)), std::invalid_argument);
  PiecewisePolynomial held(1);
  Segment hold(1);
  build_hold(Time(5), std::vector{3.0}, hold);
  held.append(hold);
  EXPECT_EQ(held.breaks().size(), 1U);
  State state(1);
  held.evaluate(Time(5), state.ref());
  EXPECT_EQ(state.position()[0], 3.0);
  EXPECT_THROW(held.append(constant(5, 20, 2)), std::invalid_argument);
}

}  // namespace
}  // namespace splinecast::core
