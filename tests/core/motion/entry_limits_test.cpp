#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "tests/core/motion/entry_trial.hpp"

/// What an entry keeps from its beginning to its end: the limits, the observed velocity and
/// acceleration, and the length of a quaternion.
namespace splinecast::core::entries {
namespace {

using std::chrono::milliseconds;

/// An entry that begins beyond a limit may keep its initial value but not exceed it.
TEST(EntrySearch, FindsEntriesThatKeepEveryLimitFromRandomStates) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> unit(-1, 1);
  const MotionLimits limits{.velocity = {1.5, 3},
                            .acceleration = {6, 12},
                            .jerk = {200, 900},
                            .lower = {-1.2, -1.4},
                            .upper = {1.2, 1.4}};
  int knots = 0;
  int ahead = 0;
  for (int i = 0; i < 300; ++i) {
    SlidingWindow target = target_of(2, sine, 3 + i % 8, limits, milliseconds(15 + i % 30));
    const double off = i % 3 == 0 ? 0.1 : 0.002;
    From from = at_rest(milliseconds(60), {0, 0});
    for (std::size_t d = 0; d < 2; ++d) {
      const double phase = 0.06 + static_cast<double>(d);
      from.position[d] = std::sin(phase) + off * unit(random);
      from.velocity[d] = std::cos(phase) + 5 * off * unit(random);
      from.acceleration[d] = i % 3 == 0 ? 8 * unit(random) : -std::sin(phase);
    }
    EntrySearch search(2, {});
    const Found found = look_for(search, target, from, {.limits = &limits, .may_end_ahead = true});
    if (found.outcome == Outcome::none) continue;
    ++(found.end.knot ? knots : ahead);
    expect_leads(found.entry, from, found.end.state);
    for (std::size_t d = 0; d < 2; ++d) {
      const double v = std::max(limits.velocity[d], std::abs(from.velocity[d]));
      const double a = std::max(limits.acceleration[d], std::abs(from.acceleration[d]));
      EXPECT_LE(peak(found.entry, 2, d, 0), limits.upper[d] * (1 + 1e-9)) << i;
      EXPECT_LE(peak(found.entry, 2, d, 1), v * (1 + 1e-9)) << i;
      EXPECT_LE(peak(found.entry, 2, d, 2), a * (1 + 1e-9)) << i;
      EXPECT_LE(peak(found.entry, 2, d, 3), limits.jerk[d] * (1 + 1e-9)) << i;
    }
  }
  EXPECT_GT(knots, 20);
  EXPECT_GT(ahead, 20);
}

TEST(EntrySearch, FindsNothingIfTheEntryOrItsStopLeavesThePositionBounds) {
  const MotionLimits limits{.acceleration = {4}, .lower = {-1}, .upper = {0.05}};
  SlidingWindow target = target_of(1, sine, 5, limits);  // beyond the bounds
  const From from = at_rest(milliseconds(50), {0});
  EntrySearch search(1, {});
  const EntryRules rules{.limits = &limits, .may_end_ahead = true};
  EXPECT_EQ(look_for(search, target, from, rules).outcome, Outcome::none);
  // The target is within the bounds, but the stop after it comes to rest outside.
  const MotionLimits near{.acceleration = {4}, .lower = {-1}, .upper = {0.3}};
  SlidingWindow moving = target_of(1, sine, 5, near);
  const EntryRules near_rules{.limits = &near, .may_end_ahead = true};
  const From before = at_rest(milliseconds(90), {sine(0.09, 0) - 0.2});
  EXPECT_EQ(look_for(search, moving, before, near_rules).outcome, Outcome::none);
}

/// A turn about one axis: (cos φ/2, 0, 0, sin φ/2).
std::vector<double> turned(double half) { return {std::cos(half), 0, 0, std::sin(half)}; }

DimensionKinds quaternion() {
  const std::vector<Dimension> dimensions(4, {.kind = DimensionKind::quaternion, .period = 0});
  return DimensionKinds(dimensions);
}

/// The first knots are far from the state, so that the straight path passes near zero; the last
/// knots are near.
TEST(EntrySearch, RefusesEntriesThatShortenAQuaternionTooMuch) {
  const double pi = std::numbers::pi;
  const Motion turn = [pi](double s, std::size_t d) {
    return turned(0.95 * pi - (s - 0.1) / 0.18 * 0.75 * pi)[d];
  };
  const MotionLimits none;
  SlidingWindow target = target_of(4, turn, 10);
  const From from = at_rest(milliseconds(80), turned(0));
  const auto shortest = [](const Segment& entry) {
    State state(4);
    double least = 1;
    const double h = to_seconds(entry.right - entry.left);
    for (int i = 0; i <= 1000; ++i) {
      evaluate(entry.order, entry.coefficients, h * i / 1000, state.ref());
      double squares = 0;
      for (const double x : state.position()) squares += x * x;
      least = std::min(least, std::sqrt(squares));
    }
    return least;
  };
  EntrySearch search(4, quaternion());
  const Found found = look_for(search, target, from, {.limits = &none});
  ASSERT_EQ(found.outcome, Outcome::found);
  ASSERT_TRUE(found.end.knot);
  EXPECT_GT(*found.end.knot, 0U);
  EXPECT_GE(shortest(found.entry), 0.69);
  for (std::size_t k = 0; k < *found.end.knot; ++k) {
    EXPECT_LT(shortest(quintic_to(target, from, k)), 0.71) << k;
  }
  // Four linear dimensions need not keep a length.
  EntrySearch linear(4, {});
  EXPECT_EQ(look_for(linear, target, from, {.limits = &none}).end.knot, 0U);
}

TEST(EntrySearch, WithoutLimitsStaysWithinTheObservedVelocityAndAcceleration) {
  const MotionLimits none;
  const MotionLimits shown{.velocity = {3}, .acceleration = {9}};
  SlidingWindow target = target_of(1, sine, 9);
  const From from = at_rest(milliseconds(90), {sine(0.09, 0) - 0.3});
  EntrySearch search(1, {});
  const Found any = look_for(search, target, from, {.limits = &none});
  ASSERT_EQ(any.outcome, Outcome::found);
  EXPECT_EQ(any.end.knot, 0U);
  EXPECT_GT(peak(any.entry, 1, 0, 2), 1000);
  const EntryRules rules{.limits = &none, .shown = &shown, .may_end_ahead = true};
  const Found found = look_for(search, target, from, rules);
  ASSERT_EQ(found.outcome, Outcome::found);
  EXPECT_LE(peak(found.entry, 1, 0, 1), 3 * (1 + 1e-9));
  EXPECT_LE(peak(found.entry, 1, 0, 2), 9 * (1 + 1e-9));
}

TEST(EntrySearch, WithoutLimitsFindsAnEntryOfAtMostThreeSecondsFromAnyState) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> exponent(-4, 4);
  std::uniform_real_distribution<double> unit(-1, 1);
  const MotionLimits none;
  const MotionLimits shown{.velocity = {0.1, 0}, .acceleration = {0.1, 0}};
  for (int i = 0; i < 200; ++i) {
    SlidingWindow target = target_of(2, sine, 1 + i % 10);
    From from = at_rest(milliseconds(80), {unit(random) * std::pow(10, exponent(random)),  //
                                           unit(random) * std::pow(10, exponent(random))});
    for (double& v : from.velocity) v = unit(random) * std::pow(10, exponent(random));
    EntrySearch search(2, {});
    const Found found = look_for(search, target, from,
                                 {.limits = &none, .shown = &shown, .may_end_ahead = true}, 4);
    ASSERT_EQ(found.outcome, Outcome::found) << i;
    EXPECT_LE(found.end.state.time - from.time, EntrySearch::kLongest);
    EXPECT_LE(found.tried, 64);
    expect_leads(found.entry, from, found.end.state);
  }
}

}  // namespace
}  // namespace splinecast::core::entries
