#include "core/limits/check.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>
#include <vector>

namespace splinecast::core {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// A segment of the given duration with the given coefficients, [power][dimension].
Segment segment_of(std::size_t dimensions, Time length, std::vector<double> coefficients) {
  Segment segment(dimensions);
  segment.right = length;
  segment.order = static_cast<int>(coefficients.size() / dimensions);
  std::ranges::copy(coefficients, segment.coefficients.begin());
  return segment;
}

/// x = 10 s³ − 15 s⁴ + 6 s⁵ over a second: v peaks at 15/8, a at 10/√3, j at 60.
Segment move_over_a_second() { return segment_of(1, Time(1'000'000'000), {0, 0, 0, 10, -15, 6}); }

Segment random_segment(std::mt19937_64& random, std::size_t dimensions) {
  std::uniform_real_distribution<double> value(-1, 1);
  const double h = std::pow(10, 3 * value(random) - 2);
  const std::size_t order = value(random) < 0 ? kCubicOrder : kMaxOrder;
  std::vector<double> coefficients(order * dimensions);
  for (std::size_t i = 0; i < coefficients.size(); ++i) {
    coefficients[i] = value(random) * std::pow(h, -static_cast<double>(i / dimensions));
  }
  const Time length(static_cast<std::int64_t>(h * 1e9));
  return segment_of(dimensions, length, coefficients);
}

MotionLimits limits_at(const WorstExcesses& peaks, std::size_t dimensions, double share) {
  MotionLimits limits;
  const auto set = [&](LimitKind kind, std::vector<double>& values) {
    const Excess& peak = peaks[static_cast<std::size_t>(kind)];
    values.assign(dimensions, 0);
    values[peak.dimension] = share * std::abs(peak.value);
  };
  set(LimitKind::velocity, limits.velocity);
  set(LimitKind::acceleration, limits.acceleration);
  set(LimitKind::jerk, limits.jerk);
  return limits;
}

TEST(LimitCheck, ALimitAtThePeakIsKeptAndALimitABillionthBelowItIsExceeded) {
  std::mt19937_64 random(1);
  const MotionLimits ones{.velocity = {1, 1}, .acceleration = {1, 1}, .jerk = {1, 1}};
  for (int i = 0; i < 20'000; ++i) {
    const Segment segment = random_segment(random, 2);
    const WorstExcesses peaks = worst_excesses(ones, nullptr, part_of(segment));
    ASSERT_TRUE(keeps_within(limits_at(peaks, 2, 1), nullptr, segment));
    for (const LimitKind kind : {LimitKind::velocity, LimitKind::acceleration, LimitKind::jerk}) {
      MotionLimits tight = limits_at(peaks, 2, 1);
      auto& values = kind == LimitKind::velocity       ? tight.velocity
                     : kind == LimitKind::acceleration ? tight.acceleration
                                                       : tight.jerk;
      for (double& value : values) value *= 1 - 1e-9;
      ASSERT_FALSE(keeps_within(tight, nullptr, segment)) << "segment " << i;
      const Excess worst = worst_excess(tight, nullptr, segment);
      ASSERT_EQ(worst.kind, kind);
      ASSERT_NEAR(worst.ratio, 1 + 1e-9, 1e-12);
      ASSERT_TRUE(first_violation(tight, nullptr, segment));
    }
  }
}

TEST(LimitCheck, AValueThatBeginsAboveItsLimitMayStayThereButNotRise) {
  const Segment move = segment_of(1, Time(1'000'000'000), {0, 2, 0.1, 0});  // 2 to 2.2
  const MotionLimits limits{.velocity = {1}};
  EXPECT_FALSE(keeps_within(limits, nullptr, move));
  const std::array allowed{2.2};
  EXPECT_TRUE(keeps_within(limits, nullptr, move, {.velocity = allowed}));
  const std::array risen{2.1};
  EXPECT_FALSE(keeps_within(limits, nullptr, move, {.velocity = risen}));
  EXPECT_NEAR(worst_excess(limits, nullptr, move, {.velocity = risen}).ratio, 2.2 / 2.1, 1e-12);
  const std::array less{0.5};
  EXPECT_EQ(worst_excess(limits, nullptr, move, {.velocity = less}).limit, 1);
  EXPECT_TRUE(keeps_within({.velocity = {0}}, nullptr, move, {.velocity = less}));
}

TEST(LimitCheck, PositionBoundsApplyToTheWholeSegment) {
  const Segment hill = segment_of(1, Time(1'000'000'000), {0, 4, -4});  // up to 1 at 0.5 s
  EXPECT_TRUE(keeps_within({.lower = {0}, .upper = {1}}, nullptr, hill));
  EXPECT_FALSE(keeps_within({.upper = {1 - 1e-9}}, nullptr, hill));
  EXPECT_FALSE(keeps_within({.lower = {1e-9}}, nullptr, hill));
  EXPECT_TRUE(keeps_within({.lower = {-kInfinity}, .upper = {kInfinity}}, nullptr, hill));
  const Excess worst = worst_excess({.lower = {-1}, .upper = {0.5}}, nullptr, hill);
  EXPECT_EQ(worst.kind, LimitKind::position);
  EXPECT_EQ(worst.limit, 0.5);
  EXPECT_NEAR(worst.value, 1, 1e-15);
  EXPECT_NEAR(worst.u, 0.5, 1e-12);
  EXPECT_NEAR(worst.ratio, 1.25 / 0.75, 1e-12);
  EXPECT_NEAR(worst_excess({.upper = {0.5}}, nullptr, hill).ratio, 1.5, 1e-12);
}

TEST(LimitCheck, AConstantBelowBothBoundsIsComparedWithTheLowerOne) {
  const Segment constant = segment_of(1, Time(1'000'000'000), {-3});
  const Excess worst = worst_excess({.lower = {-1}, .upper = {1}}, nullptr, constant);
  EXPECT_EQ(worst.limit, -1);
  EXPECT_EQ(worst.value, -3);
  EXPECT_EQ(worst.ratio, 3);
}

TEST(LimitCheck, TheFirstViolationIsAtTheFirstTimeBeyondTheLimit) {
  const Segment move = move_over_a_second();
  // v = 30 s² (1 − s)² reaches 1 at s (1 − s) = 1/√30.
  const auto first = first_violation({.velocity = {1}, .jerk = {100}}, nullptr, move);
  ASSERT_TRUE(first);
  EXPECT_EQ(first->kind, LimitKind::velocity);
  EXPECT_NEAR(first->u, (1 - std::sqrt(1 - 4 / std::sqrt(30.0))) / 2, 2e-9);
  EXPECT_NEAR(first->value, 1, 1e-8);
  EXPECT_GT(first->ratio, 1);
  // The jerk begins with 60.
  EXPECT_EQ(first_violation({.velocity = {1}, .jerk = {50}}, nullptr, move)->u, 0);
  EXPECT_FALSE(first_violation({.velocity = {1.875}, .jerk = {60}}, nullptr, move));
}

TEST(LimitCheck, ASegmentWithNaNCoefficientsExceedsEveryLimit) {
  Segment bad = move_over_a_second();
  bad.coefficients[1] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(keeps_within({.velocity = {1e9}}, nullptr, bad));
  EXPECT_FALSE(keeps_within({.lower = {-1e9}}, nullptr, bad));
  EXPECT_EQ(worst_excess({.velocity = {1e9}}, nullptr, bad).ratio, kInfinity);
  EXPECT_TRUE(keeps_within({}, nullptr, bad));
}

/// Largest |ω|, |α| and |α̇| of a quaternion at many times; the last by differences of α.
std::array<double, 3> sampled_rates(const Segment& segment, const DimensionKinds& kinds) {
  const QuaternionDimensions quaternion = kinds.quaternions().front();
  const double h = to_seconds(segment.right - segment.left);
  const auto motion_at = [&](double u) {
    State state(segment.acceleration_step.size());
    evaluate(segment.order, segment.coefficients, u, state.ref());
    kinds.normalise(state.ref());
    return angular_motion(quaternion, state.position(), state.velocity(), state.acceleration());
  };
  const auto norm = [](const Vector3& a) { return std::hypot(a[0], a[1], a[2]); };
  std::array<double, 3> most{};
  const double step = h / 4000;
  Vector3 before = motion_at(0).acceleration;
  for (int i = 0; i <= 4000; ++i) {
    const AngularMotion motion = motion_at(step * i);
    Vector3 change{};
    for (std::size_t k = 0; k < 3; ++k) change[k] = (motion.acceleration[k] - before[k]) / step;
    before = motion.acceleration;
    most = {std::max(most[0], norm(motion.velocity)), std::max(most[1], norm(motion.acceleration)),
            std::max(most[2], norm(change))};
  }
  return most;
}

DimensionKinds rotation_after_one_dimension(DimensionKind kind) {
  std::vector<Dimension> dimensions(5, {.kind = kind});
  dimensions[0] = {};
  return DimensionKinds(dimensions);
}

TEST(LimitCheck, TheLimitsOfAQuaternionApplyToItsAngularMotion) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> value(-1, 1);
  for (int i = 0; i < 60; ++i) {
    const bool w_first = i % 2 == 0;
    const DimensionKinds kinds = rotation_after_one_dimension(
        w_first ? DimensionKind::quaternion_wxyz : DimensionKind::quaternion);
    std::vector<double> c(6 * 5);
    for (double& each : c) each = 0.2 * value(random);
    c[w_first ? 1 : 4] = 1;
    const Segment segment = segment_of(5, Time(1'000'000'000), c);
    const MotionLimits ones{
        .velocity = {0, 1, 0, 0, 0}, .acceleration = {0, 1, 0, 0, 0}, .jerk = {0, 1, 0, 0, 0}};
    const WorstExcesses worst = worst_excesses(ones, &kinds, part_of(segment));
    const std::array<double, 3> sampled = sampled_rates(segment, kinds);
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_NEAR(worst[k].value, sampled[k], (k == 2 ? 0.01 : 1e-4) * sampled[k]) << k;
      EXPECT_EQ(worst[k].dimension, 1U);
    }
    EXPECT_TRUE(keeps_within(limits_at(worst, 5, 1), &kinds, segment));
    EXPECT_FALSE(keeps_within(limits_at(worst, 5, 0.99), &kinds, segment));
    const std::array allowed{0.0, worst[0].value, 0.0, 0.0, 0.0};
    EXPECT_TRUE(
        keeps_within({.velocity = {0, 1e-3, 0, 0, 0}}, &kinds, segment, {.velocity = allowed}));
    EXPECT_TRUE(first_violation(limits_at(worst, 5, 0.9), &kinds, segment));
  }
}

TEST(LimitCheck, ATurnAtNearlyConstantSpeedHasNearlyNoAngularAcceleration) {
  // cos and sin of half the angle by their series, 0.2 rad/s over a second.
  const double w = 0.1;
  const Segment turn =
      segment_of(4, Time(1'000'000'000), {0, 0,          0, 1, 0,
                                          0, w,          0, 0, 0,
                                          0, -w * w / 2, 0, 0, -w * w * w / 6,
                                          0, 0,          0, 0, w * w * w * w / 24});
  const std::vector<Dimension> quaternion(4, {.kind = DimensionKind::quaternion});
  const DimensionKinds kinds(quaternion);
  EXPECT_TRUE(keeps_within({.velocity = {0.2 + 1e-6, 0, 0, 0}, .acceleration = {1e-5, 0, 0, 0}},
                           &kinds, turn));
  EXPECT_FALSE(keeps_within({.velocity = {0.2 - 1e-6, 0, 0, 0}}, &kinds, turn));
}

TEST(LimitCheck, AQuaternionThatPassesThroughZeroExceedsEveryLimit) {
  const Segment through = segment_of(4, Time(1'000'000'000), {0, 0, 0, 1, 0, 0, 0, -2});
  const std::vector<Dimension> quaternion(4, {.kind = DimensionKind::quaternion});
  const DimensionKinds kinds(quaternion);
  EXPECT_FALSE(keeps_within({.velocity = {1e6, 0, 0, 0}}, &kinds, through));
}

TEST(MotionLimits, InvalidLimitsAreRefusedWithTheirValue) {
  const auto refusal = [](const MotionLimits& limits, const std::vector<Dimension>& dimensions) {
    try {
      require_limits(limits, dimensions);
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  const std::vector<Dimension> two(2);
  EXPECT_EQ(refusal({.velocity = {1, 2}, .lower = {-1, -kInfinity}, .upper = {1, 5}}, two), "");
  EXPECT_NE(refusal({.velocity = {-1, 2}}, two).find("velocity limit must be positive"),
            std::string::npos);
  EXPECT_NE(refusal({.jerk = {1}}, two).find("1 jerk limits for 2 dimensions"), std::string::npos);
  EXPECT_NE(refusal({.lower = {2, 0}, .upper = {1, 1}}, two).find("not 2 and 1"),
            std::string::npos);
  const std::vector<Dimension> wrap{{.kind = DimensionKind::periodic, .period = 360}};
  EXPECT_NE(refusal({.upper = {1}}, wrap).find("periodic:360, which has no bounds"),
            std::string::npos);
  EXPECT_EQ(refusal({.velocity = {1}, .upper = {kInfinity}}, wrap), "");
  const std::vector<Dimension> quaternion(4, {.kind = DimensionKind::quaternion});
  EXPECT_EQ(refusal({.velocity = {1, 1, 1, 1}, .jerk = {1, 0, 0, 0}}, quaternion), "");
  EXPECT_NE(refusal({.velocity = {1, 2, 1, 1}}, quaternion).find("first dimension, 0"),
            std::string::npos);
}

TEST(MotionLimits, OneValueIsSpreadOverAllDimensions) {
  const MotionLimits limits = spread({.velocity = {2}, .jerk = {1, 2, 3}}, 3);
  EXPECT_EQ(limits.velocity, (std::vector<double>{2, 2, 2}));
  EXPECT_EQ(limits.jerk, (std::vector<double>{1, 2, 3}));
  EXPECT_TRUE(limits.acceleration.empty());
  EXPECT_THROW((void)spread({.velocity = {1, 2}}, 3), std::invalid_argument);
  EXPECT_TRUE(MotionLimits{}.empty());
  EXPECT_TRUE((MotionLimits{.velocity = {0}, .lower = {-kInfinity}}).empty());
  EXPECT_FALSE((MotionLimits{.upper = {0}}).empty());
}

}  // namespace
}  // namespace splinecast::core
