#include <gtest/gtest.h>

#include <chrono>
#include <cmath>

#include "tests/core/motion/entry_trial.hpp"

/// Which starts from rest need no entry.
namespace splinecast::core::entries {
namespace {

using std::chrono::milliseconds;

/// Whether a stream may start at rest with the first `knots` waypoints of a motion.
bool keeps_start(const Motion& motion, int knots, Time step, const MotionLimits& limits,
                 const MotionLimits* shown) {
  WindowOptions how{.start = {.kind = ConditionKind::halt, .value = {}}, .limits = limits};
  SlidingWindow window(1, how);
  for (int i = 0; i < knots; ++i) {
    const double x = motion(to_seconds(i * step), 0);
    window.append({.time = i * step, .position = {&x, 1}});
  }
  EntrySearch search(1, {});
  return search.keeps_start(window, {.limits = &limits, .shown = shown});
}

double slow(double s, std::size_t /*d*/) { return 1 - std::cos(s); }
double sudden(double s, std::size_t /*d*/) { return s; }  // velocity 1 from the beginning

TEST(EntrySearch, AllowsAStartWhoseSegmentsKeepTheLimits) {
  for (const int knots : {2, 3, 5, 8}) {
    const MotionLimits limits{.acceleration = {10}};
    EXPECT_TRUE(keeps_start(slow, knots, milliseconds(20), limits, nullptr)) << knots;
    EXPECT_FALSE(keeps_start(sudden, knots, milliseconds(20), limits, nullptr)) << knots;
    EXPECT_TRUE(keeps_start(sudden, knots, milliseconds(20), {}, nullptr)) << knots;
  }
}

TEST(EntrySearch, WithoutALimitAllowsAStartWithinTheObservedVelocityAndAcceleration) {
  const MotionLimits shown{.velocity = {3}, .acceleration = {4}};
  for (const int knots : {2, 3, 4, 5, 8}) {
    EXPECT_TRUE(keeps_start(slow, knots, milliseconds(20), {}, &shown)) << knots;
    EXPECT_FALSE(keeps_start(sudden, knots, milliseconds(20), {}, &shown)) << knots;
  }
  // A given limit replaces the observed one.
  const MotionLimits wide{.acceleration = {10'000}};
  EXPECT_TRUE(keeps_start(sudden, 8, milliseconds(20), wide, &shown));
}

/// The limits that the first waypoints of a motion at 30 Hz show: three times the mean velocity,
/// and the mean velocity divided by the stop time as acceleration.
MotionLimits shown_at_30_hz(const Motion& motion, Time step) {
  const double mean =
      std::abs(motion(to_seconds(2 * step), 0) - motion(0, 0)) / to_seconds(2 * step);
  return {.velocity = {3 * mean}, .acceleration = {mean / to_seconds(WindowOptions().stop_length)}};
}

TEST(EntrySearch, AllowsNoStartInMidMotionIfThreeWaypointsAreKnown) {
  const Time step{33'333'333};
  for (const double phase : {0.0, 0.3, 0.6, 2.5}) {
    const Motion moving = [phase](double s, std::size_t) { return std::sin(2 * s + phase); };
    const MotionLimits shown = shown_at_30_hz(moving, step);
    for (const int knots : {3, 4}) {
      EXPECT_FALSE(keeps_start(moving, knots, step, {}, &shown)) << phase << ' ' << knots;
    }
  }
}

TEST(EntrySearch, AllowsTheStartOfAMinimumJerkMotionIfThreeWaypointsAreKnown) {
  const Time step{33'333'333};
  for (const double duration : {0.5, 1.0, 2.0, 5.0}) {
    const Motion min_jerk = [duration](double s, std::size_t) {
      const double u = s / duration;
      return u * u * u * (10 + u * (-15 + u * 6));
    };
    const MotionLimits shown = shown_at_30_hz(min_jerk, step);
    for (const int knots : {3, 4}) {
      EXPECT_TRUE(keeps_start(min_jerk, knots, step, {}, &shown)) << duration << ' ' << knots;
    }
  }
}

}  // namespace
}  // namespace splinecast::core::entries
