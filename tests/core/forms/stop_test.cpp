#include "core/forms/stop.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <random>
#include <span>
#include <utility>
#include <vector>

#include "core/limits/limit_of.hpp"
#include "core/online/sliding_window.hpp"
#include "splinecast/dimension_kind.hpp"
#include "splinecast/state.hpp"
#include "tests/fixtures/curves/mesh.hpp"

namespace splinecast::core {
namespace {

using std::chrono::milliseconds;

const DimensionKinds kAllLinear;

Time from_seconds(double seconds) { return Time(std::llround(seconds * 1e9)); }

/// Calls `look` with the state at many times of a segment, including both ends.
template <typename Look>
void for_each_state(const Segment& segment, std::size_t dimensions, const Look& look) {
  constexpr int kLooks = 1000;
  State state(dimensions);
  const double h = to_seconds(segment.right - segment.left);
  for (int i = 0; i <= kLooks; ++i) {
    evaluate(segment.order, segment.coefficients, h * i / kLooks, state.ref());
    look(state, h * i / kLooks);
  }
}

/// Largest absolute acceleration and jerk of dimension 0.
struct Peaks {
  double acceleration = 0;
  double jerk = 0;
};

Peaks sampled_peaks(Time stop_length, double v, double a) {
  const std::array x{0.0};
  Segment stop(1);
  build_stop(Time(0), stop_length, x, {&v, 1}, {&a, 1}, stop);
  Peaks peaks;
  for_each_state(stop, 1, [&](const State& at, double) {
    peaks.acceleration = std::max(peaks.acceleration, std::abs(at.acceleration()[0]));
    peaks.jerk = std::max(peaks.jerk, std::abs(at.jerk()[0]));
  });
  return peaks;
}

Time stop_length(double v, double a, const MotionLimits& limits, Time stop_length = kLeastStopTime,
                 double x = 0) {
  return stop_time_within({limits, kAllLinear, stop_length}, {Time(0), {&x, 1}, {&v, 1}, {&a, 1}});
}

Time stop_length(double v, double a, double limit, Time least = kLeastStopTime) {
  return stop_length(v, a, MotionLimits{.acceleration = {limit}}, least);
}

TEST(StopSegment, NeverSpeedsUpOrReversesOrTravelsFurtherThanHalfItsTimeAtItsVelocity) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> exponent(-3, 3);
  constexpr std::size_t kDimensions = 5;  // some in a SIMD vector, one in the remainder
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    const auto x = testing::random_values(3 * seed, kDimensions);
    auto v = testing::random_values(3 * seed + 1, kDimensions);
    auto a = testing::random_values(3 * seed + 2, kDimensions);
    for (double& value : v) value *= std::pow(10, exponent(random));
    for (double& value : a) value *= std::pow(10, 2 * exponent(random));
    const Time time = from_seconds(std::pow(10, exponent(random) - 1));
    Segment stop(kDimensions);
    build_stop(Time(7), time, x, v, a, stop);
    EXPECT_EQ(stop.left, Time(7));
    EXPECT_EQ(stop.right, Time(7) + time);
    std::vector<double> before = v;
    for_each_state(stop, kDimensions, [&](const State& at, double) {
      for (std::size_t d = 0; d < kDimensions; ++d) {
        const double rounding = 1e-12 * std::abs(v[d]);
        ASSERT_LE(std::abs(at.velocity()[d]), std::abs(before[d]) + rounding) << seed;
        ASSERT_GE(at.velocity()[d] * v[d], -rounding * std::abs(v[d])) << seed;
        before[d] = at.velocity()[d];
        const double way = std::abs(v[d]) * to_seconds(time) / 2;
        ASSERT_LE(std::abs(at.position()[d] - x[d]), way * (1 + 1e-9) + 1e-12) << seed;
        ASSERT_LE(std::abs(at.acceleration()[d]),
                  3 * std::abs(v[d]) / to_seconds(time) * (1 + 1e-9));
      }
    });
  }
}

TEST(StopSegment, BeginsWithItsStateAndComesToAFullStop) {
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    const auto x = testing::random_values(3 * seed, 3);
    const auto v = testing::random_values(3 * seed + 1, 3);
    std::vector<double> a(3);
    for (std::size_t d = 0; d < 3; ++d) a[d] = -2 * v[d];  // within 0 … −3v/T
    Segment stop(3);
    build_stop(Time(0), milliseconds(700), x, v, a, stop);
    State state(3);
    evaluate(stop.order, stop.coefficients, 0, state.ref());
    EXPECT_TRUE(std::ranges::equal(state.position(), x));
    EXPECT_TRUE(std::ranges::equal(state.velocity(), v));
    EXPECT_TRUE(std::ranges::equal(state.acceleration(), a));
    evaluate(stop.order, stop.coefficients, 0.7, state.ref());
    for (std::size_t d = 0; d < 3; ++d) {
      EXPECT_NEAR(state.velocity()[d], 0, 1e-14);
      EXPECT_NEAR(state.acceleration()[d], 0, 1e-13);
      EXPECT_NEAR(state.position()[d], x[d] + v[d] * 0.7 / 2 + a[d] * 0.49 / 12, 1e-15);
    }
  }
}

TEST(StopSegment, ClampsItsInitialAccelerationToTheRangeWithoutReversal) {
  EXPECT_EQ(stop_acceleration(2, -5, 0.5), -5);
  EXPECT_EQ(stop_acceleration(2, -12, 0.5), -12);
  EXPECT_EQ(stop_acceleration(2, -12.1, 0.5), -12);
  EXPECT_EQ(stop_acceleration(2, 1, 0.5), 0);
  EXPECT_EQ(stop_acceleration(-2, 5, 0.5), 5);
  EXPECT_EQ(stop_acceleration(-2, 100, 0.5), 12);
  EXPECT_EQ(stop_acceleration(-2, -1, 0.5), 0);
  EXPECT_EQ(stop_acceleration(0, 7, 0.5), 0);
  EXPECT_EQ(stop_acceleration(0, -7, 0.5), 0);
}

TEST(StopSegment, ClampsEachDimensionLikeAStopOfOneDimension) {
  for (std::size_t dimensions = 1; dimensions <= 9; ++dimensions) {
    const auto x = testing::random_values(dimensions, dimensions);
    const auto v = testing::random_values(dimensions + 20, dimensions);
    auto a = testing::random_values(dimensions + 40, dimensions);
    for (double& value : a) value *= 20;
    Segment stop(dimensions);
    build_stop(Time(0), milliseconds(250), x, v, a, stop);
    for (std::size_t d = 0; d < dimensions; ++d) {
      EXPECT_EQ(2 * stop.coefficients[2 * dimensions + d], stop_acceleration(v[d], a[d], 0.25));
    }
  }
}

/// Also if the state decelerates beyond the limit: the stop clamps its initial acceleration.
TEST(StopSegment, KeepsItsAccelerationLimitFromItsBeginning) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> value(-10, 10);
  for (int i = 0; i < 2000; ++i) {
    const double v = value(random);
    const double a = i % 5 == 0 ? 0 : value(random) * (i % 3 == 0 ? 10 : 1);
    const double limit = 1 + std::abs(value(random));
    const Time time = stop_length(v, a, limit);
    EXPECT_LE(sampled_peaks(time, v, a).acceleration, limit * (1 + 1e-6)) << v << ' ' << a;
    const Time longer = time + milliseconds(1 + i % 400);
    EXPECT_LE(sampled_peaks(longer, v, a).acceleration, limit * (1 + 1e-6)) << v << ' ' << a;
  }
}

TEST(StopSegment, TakesNoLongerThanItsAccelerationLimitRequires) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> value(-10, 10);
  for (int i = 0; i < 2000; ++i) {
    const double limit = 1 + std::abs(value(random));
    const double v = value(random);
    // A deceleration within the limit, or an acceleration, which the stop clamps to 0.
    const double a = std::clamp(value(random), -limit, limit);
    const Time time = stop_length(v, a, limit);
    if (time == kLeastStopTime) continue;
    const bool decelerates = v * a < 0;
    if (!decelerates) {
      EXPECT_NEAR(to_seconds(time), 1.5 * std::abs(v) / limit, 2e-9);
    }
    // A stop that begins near its limit has its peak at its beginning, for any stop time.
    if (decelerates && std::abs(a) > 0.9 * limit) continue;
    const Time shorter = from_seconds(0.99 * to_seconds(time));
    EXPECT_GT(sampled_peaks(shorter, v, a).acceleration, limit) << v << ' ' << a << ' ' << limit;
  }
}

TEST(StopSegment, ThatDeceleratesBeyondItsLimitTakesThreeTimesTheVelocityOverTheLimit) {
  EXPECT_NEAR(to_seconds(stop_length(2, -50, 10)), 0.6, 2e-9);
  EXPECT_NEAR(to_seconds(stop_length(-2, 50, 10)), 0.6, 2e-9);
  EXPECT_LE(sampled_peaks(stop_length(2, -50, 10), 2, -50).acceleration, 10 * (1 + 1e-9));
}

TEST(StopSegment, KeepsItsJerkLimit) {
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> value(-10, 10);
  for (int i = 0; i < 500; ++i) {
    const double v = value(random);
    const double a = 10 * value(random);
    const double limit = 1 + 10 * std::abs(value(random));
    const Time time = stop_length(v, a, MotionLimits{.jerk = {limit}});
    EXPECT_LE(sampled_peaks(time, v, a).jerk, limit * (1 + 1e-6)) << v << ' ' << a;
    const double shorter = 0.99 * to_seconds(time);
    EXPECT_GT(sampled_peaks(from_seconds(shorter), v, 0).jerk, limit) << v;
  }
}

TEST(StopSegment, TakesAsLongAsTheDimensionThatNeedsLongest) {
  const std::array v{1.0, -3.0, 20.0};
  const std::array a{0.0, 0.0, 0.0};
  const MotionLimits limits{.acceleration = {10, 10, 0}};  // the last dimension has no limit
  const Instant from{Time(0), a, v, a};
  EXPECT_NEAR(to_seconds(stop_time_within({limits, kAllLinear, kLeastStopTime}, from)), 0.45, 2e-9);
  EXPECT_EQ(stop_time_within({limits, kAllLinear, milliseconds(500)}, from), milliseconds(500));
  EXPECT_EQ(stop_time_within({{}, kAllLinear, milliseconds(250)}, from), milliseconds(250));
}

/// The largest position of a stop, or the least if it moves down.
double farthest(Time length, double x, double v, double a) {
  Segment stop(1);
  build_stop(Time(0), length, {&x, 1}, {&v, 1}, {&a, 1}, stop);
  double far = x;
  for_each_state(stop, 1, [&](const State& at, double) {
    far = v > 0 ? std::max(far, at.position()[0]) : std::min(far, at.position()[0]);
  });
  return far;
}

TEST(StopSegment, RestsWhereItsFormulaSaysForEveryLength) {
  std::mt19937_64 random(8);
  std::uniform_real_distribution<double> value(-10, 10);
  for (int i = 0; i < 300; ++i) {
    const double x = value(random);
    const double v = value(random);
    const double a = 30 * value(random);
    const Time length = from_seconds(std::pow(10, value(random) / 5 - 1));
    const Instant from{Time(0), {&x, 1}, {&v, 1}, {&a, 1}};
    EXPECT_NEAR(stop_position(from, 0, length), farthest(length, x, v, a), 1e-12 * (1 + 10)) << i;
  }
}

TEST(StopSegment, IsTheLongestThatKeepsItsBoundsAndNeverShorterThanTheLimitsNeed) {
  std::mt19937_64 random(9);
  std::uniform_real_distribution<double> value(-1, 1);
  constexpr Time kStop = milliseconds(250);
  int shortened = 0;
  int passing = 0;
  for (int i = 0; i < 2000; ++i) {
    const double x = value(random);
    const double v = 5 * value(random);
    const double a = 40 * value(random);
    const MotionLimits limits{.acceleration = {60}, .lower = {-1}, .upper = {1}};
    const Instant from{Time(0), {&x, 1}, {&v, 1}, {&a, 1}};
    const Time least = std::max(least_stop_time(limits, kAllLinear, from), Time(1));
    const Time length = stop_length(v, a, limits, kStop, x);
    const Time most = std::max(kStop, least);
    ASSERT_GE(length, least) << i;
    ASSERT_LE(length, most) << i;
    EXPECT_LE(sampled_peaks(length, v, a).acceleration, 60 * (1 + 1e-6)) << i;
    const bool passes = std::abs(farthest(length, x, v, a)) > 1 + 1e-12;
    if (passes) {
      EXPECT_EQ(length, least) << i;
    }
    if (length < most && length > least) {
      EXPECT_GT(std::abs(stop_position(from, 0, length + Time(1))), 1.0) << i;
    }
    shortened += length < most && !passes;
    passing += passes;
  }
  EXPECT_GT(shortened, 100);
  EXPECT_GT(passing, 50);
}

TEST(StopSegment, TakesTheStopTimeWithBoundsButWithoutALimitOfAcceleration) {
  const MotionLimits bounds{.velocity = {1}, .lower = {-1}, .upper = {1}};
  EXPECT_EQ(stop_length(2, 0, bounds, milliseconds(250), 0.9), milliseconds(250));
  const MotionLimits without{.acceleration = {0}, .lower = {-1}, .upper = {1}};
  EXPECT_EQ(stop_length(2, 0, without, milliseconds(250), 0.9), milliseconds(250));
  const MotionLimits with{.acceleration = {100}, .lower = {-1}, .upper = {1}};
  EXPECT_EQ(stop_length(2, 0, with, milliseconds(250), 0.9), milliseconds(100));
}

/// Angular speed and acceleration of a quaternion x y z w.
struct Turn {
  double speed = 0;
  double acceleration = 0;
};

/// The values at the begin of a stop and its largest ones.
std::pair<Turn, Turn> turns_of(const Segment& stop, const DimensionKinds& kinds) {
  Turn first;
  Turn most;
  for_each_state(stop, 4, [&](State state, double u) {
    kinds.normalise(state.ref());
    const auto size = [](std::span<const double> q) { return std::hypot(q[0], q[1], q[2]); };
    // Of a unit quaternion |q̇| = |ω|/2, and |ω̇| is twice q̈ without its part along q.
    double along = 0;
    for (std::size_t d = 0; d < 4; ++d) along += state.acceleration()[d] * state.position()[d];
    std::array<double, 4> rest{};
    for (std::size_t d = 0; d < 4; ++d) {
      rest[d] = state.acceleration()[d] - along * state.position()[d];
    }
    const Turn turn{2 * std::hypot(size(state.velocity()), state.velocity()[3]),
                    2 * std::hypot(size(rest), rest[3])};
    if (u == 0) first = turn;
    most = {std::max(most.speed, turn.speed), std::max(most.acceleration, turn.acceleration)};
  });
  return {first, most};
}

TEST(StopSegment, OfAQuaternionKeepsTheLimitsOfItsRotation) {
  const std::array dimensions{
      Dimension{.kind = DimensionKind::quaternion}, Dimension{.kind = DimensionKind::quaternion},
      Dimension{.kind = DimensionKind::quaternion}, Dimension{.kind = DimensionKind::quaternion}};
  const DimensionKinds kinds(dimensions);
  const MotionLimits limits{.acceleration = {3, 3, 3, 3}};
  std::mt19937_64 random(10);
  std::uniform_real_distribution<double> value(-1, 1);
  double worst = 0;
  for (int i = 0; i < 500; ++i) {
    const double angle = value(random);
    const std::array q{std::sin(angle), 0.0, 0.0, std::cos(angle)};
    // Velocity and acceleration are at right angles to q.
    std::array v{value(random), value(random), value(random), value(random)};
    std::array a{value(random), value(random), value(random), value(random)};
    for (double& part : v) part *= 0.3;
    for (auto* values : {&v, &a}) {
      double along = 0;
      for (std::size_t d = 0; d < 4; ++d) along += (*values)[d] * q[d];
      for (std::size_t d = 0; d < 4; ++d) (*values)[d] -= along * q[d];
    }
    Segment stop(4);
    const Time length =
        build_stop_within({limits, kinds, milliseconds(250)}, {Time(0), q, v, a}, stop);
    const auto [first, most] = turns_of(stop, kinds);
    EXPECT_LE(most.acceleration, 3 * (1 + 1e-9)) << i;
    EXPECT_LE(most.speed, first.speed * (1 + 1e-9)) << i;
    EXPECT_LE(to_seconds(length), 1.5 * first.speed / 3 + 0.25) << i;
    worst = std::max(worst, most.acceleration);
  }
  EXPECT_GT(worst, 2.7);  // the stop is not much longer than needed
}

TEST(StopSegment, OfAStreamThatFollowsALawKeepsTheLimitsAtItsLargestRate) {
  const MotionLimits given{.velocity = {8}, .acceleration = {8}, .jerk = {8}, .upper = {8}};
  const MotionLimits limits = limits_at_rate(given, 2);
  EXPECT_EQ(limits.velocity[0], 4);
  EXPECT_EQ(limits.acceleration[0], 2);
  EXPECT_EQ(limits.jerk[0], 1);
  EXPECT_EQ(limits.upper[0], 8);
  EXPECT_EQ(limits_at_rate(given, 0.5), given);
}

TEST(StopSegment, OfAnyStateTakesAFiniteTime) {
  constexpr double kTiny = std::numeric_limits<double>::denorm_min();
  const std::array values{0.0,    kTiny,   3 * kTiny, -17 * kTiny, 1e-310,
                          1e-300, -1e-100, 1.0,       1e100,       -1e200};
  for (const double v : values) {
    for (const double a : values) {
      for (const double limit : {kTiny, 1e-310, 1e-100, 1e-3, 4.0, 10.0, 1e100}) {
        const Time time = stop_length(v, a, limit);
        EXPECT_GE(time, kLeastStopTime);
        EXPECT_LE(to_seconds(time), 1e6);
        const Time with_jerk = stop_length(v, a, MotionLimits{.jerk = {limit}});
        EXPECT_GE(with_jerk, kLeastStopTime);
        EXPECT_LE(to_seconds(with_jerk), 1e6);
      }
    }
  }
}

/// Velocities decay by a factor of 0.27 per knot until they are denormal.
TEST(StopSegment, IsValidWhileOnePositionRepeatsUntilVelocitiesAreDenormal) {
  for (const Tail tail : {Tail::natural, Tail::parabolic, Tail::bessel}) {
    WindowOptions options{.tail = tail, .limits = {.acceleration = {10}}};
    SlidingWindow window(1, options);
    Segment last(1);
    for (int i = 0; i < 2000; ++i) {
      const double x = i < 20 ? std::sin(i) : 0;
      window.append({.time = milliseconds(10 * i), .position = {&x, 1}});
      window.segment(window.segments() - 1, last);
      ASSERT_EQ(last.kind, SegmentKind::stop);
      ASSERT_GE(last.right - last.left, options.stop_length);
    }
  }
}

}  // namespace
}  // namespace splinecast::core
