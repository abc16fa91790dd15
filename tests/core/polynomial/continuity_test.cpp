#include "core/polynomial/continuity.hpp"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <algorithm>
#include <vector>

#include "splinecast/calculus.hpp"
#include "tests/fixtures/curves/generators.hpp"

namespace splinecast::core {
namespace {

using testing::random_mesh;

TEST(Continuity, BatchSplinesAreC2OnUnevenMeshesAndFarFromZero) {
  EXPECT_TRUE(rc::check("C2", [](std::uint64_t seed, bool halts, bool far) {
    auto mesh = random_mesh(seed, 2 + seed % 60, 2, 1000);
    if (far) {
      for (double& x : mesh.positions) x += 1e6;
    }
    const auto curve = testing::batch_curve(mesh, halts);
    for (std::size_t i = 1; i < curve.segments(); ++i) RC_ASSERT(continuity(curve, i) == 2);
  }));
}

TEST(Continuity, KnotsFrozenBeforeLaterKnotsArriveAreC1) {
  for (const std::size_t settle : {0U, 1U, 2U, 4U, 8U}) {
    EXPECT_TRUE(rc::check("C1", [settle](std::uint64_t seed) {
      const auto curve = testing::online_curve(random_mesh(seed, 60, 2, 5), settle, true);
      for (std::size_t i = 1; i + 1 + settle < curve.segments(); ++i) {
        RC_ASSERT(continuity(curve, i) == 1);
      }
    }));
  }
}

TEST(Continuity, AStepOfAMillionthInAccelerationVelocityOrPositionIsDetected) {
  const auto smooth = testing::batch_curve(random_mesh(5, 20, 2, 10), false);
  for (const int r : {0, 1, 2}) {
    const double step = 1e-6 * testing::largest(smooth, r);
    PiecewisePolynomial curve(2);
    for (std::size_t i = 0; i < smooth.segments(); ++i) {
      std::vector<double> c(smooth.coefficients(i).begin(), smooth.coefficients(i).end());
      if (i == 10) c[2 * static_cast<std::size_t>(r) + 1] += step;
      curve.append(smooth.left_of(i), smooth.right_of(i), 4, c);
    }
    EXPECT_EQ(continuity(curve, 10), r - 1);
    EXPECT_EQ(continuity(curve, 9), 2);
  }
}

TEST(Continuity, DoesNotDependOnTheOrderThatASegmentIsRaisedTo) {
  EXPECT_TRUE(rc::check("orders", [](std::uint64_t seed) {
    const auto curve = testing::random_curve(seed, 2, 1000);
    const auto high = raised(curve, 10);
    for (std::size_t i = 1; i < curve.segments(); ++i) {
      RC_ASSERT(continuity(high, i) == continuity(curve, i));
    }
  }));
}

TEST(Continuity, ConstantSegmentsAreC2IfEqualAndDiscontinuousIfNot) {
  PiecewisePolynomial curve(1);
  curve.append(Time(0), Time(10), 1, std::vector{3.0});
  curve.append(Time(10), Time(20), 4, std::vector{3.0, 0.0, 0.0, 0.0});
  curve.append(Time(20), Time(30), 1, std::vector{4.0});
  EXPECT_EQ(continuity(curve, 1), 2);
  EXPECT_EQ(continuity(curve, 2), -1);
}

}  // namespace
}  // namespace splinecast::core
