#include "core/motion/entry_search.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <random>
#include <utility>
#include <vector>

#include "tests/core/motion/entry_trial.hpp"

/// Which end a search chooses for its entry, and after how many tries.
namespace splinecast::core::entries {
namespace {

using std::chrono::milliseconds;

TEST(EntrySearch, TakesTheFirstKnotThatTheLimitsAllow) {
  const MotionLimits limits{.velocity = {4}, .acceleration = {20}};
  SlidingWindow target = target_of(1, sine, 10, limits);
  int later = 0;
  for (int i = 0; i < 40; ++i) {
    const From from = at_rest(milliseconds(50), {sine(0.05, 0) + 0.01 * (i - 20)});
    EntrySearch search(1, {});
    const Found found = look_for(search, target, from, {.limits = &limits, .may_end_ahead = true});
    ASSERT_EQ(found.outcome, Outcome::found) << i;
    // An entry without a knot ends after the newest knot; the newest knot itself is not checked.
    const std::size_t end = found.end.knot.value_or(target.knots() - 1);
    for (std::size_t k = 0; k < end; ++k) {
      EXPECT_FALSE(keeps_within(limits, nullptr, quintic_to(target, from, k))) << i << ' ' << k;
    }
    later += end > 0 ? 1 : 0;
    EXPECT_EQ(found.end.known, target.knots());
    expect_leads(found.entry, from, found.end.state);
    if (!found.end.knot) continue;
    EXPECT_TRUE(keeps_within(limits, nullptr, found.entry)) << i;
    EXPECT_EQ(found.entry.coefficients, quintic_to(target, from, end).coefficients);
    EXPECT_EQ(found.end.state.time, target.time(end));
  }
  EXPECT_GT(later, 20);
}

TEST(EntrySearch, PassesOverKnotsThatAreCloserThanTheShortestEntry) {
  const MotionLimits none;
  SlidingWindow target = target_of(1, sine, 10);
  const From from = at_rest(milliseconds(90), {sine(0.09, 0)});
  EntrySearch search(1, {});
  for (const auto& [least, knot] : std::vector<std::pair<int, std::size_t>>{
           {0, 0}, {10, 0}, {11, 1}, {30, 1}, {31, 2}, {110, 5}}) {
    const Found found =
        look_for(search, target, from, {.limits = &none, .least = milliseconds(least)});
    ASSERT_EQ(found.outcome, Outcome::found) << least;
    EXPECT_EQ(found.end.knot, knot) << least;
  }
}

/// The target is a line up to a bound that only the stop after it passes.
TEST(EntrySearch, AnEntryToAKnotCountsTheStopAfterTheNewestOneIfTheRulesDo) {
  const MotionLimits limits{.acceleration = {5}, .upper = {1}};
  const auto line = [](double s, std::size_t) { return 0.5 + s; };
  SlidingWindow target = target_of(1, line, 20, limits);
  ASSERT_LT(target.knot(19).waypoint[0], 1);
  const From from{milliseconds(0), {0.4}, {0.9}, {0}};
  EntrySearch search(1, {});
  EXPECT_TRUE(look_for(search, target, from, {.limits = &limits}).end.knot);
  const Found found = look_for(search, target, from, {.limits = &limits, .checks_stop = true});
  EXPECT_EQ(found.outcome, Outcome::none);
}

TEST(EntrySearch, EndsAlsoWithAShortestEntryOfOneNanosecond) {
  const MotionLimits limits{.velocity = {1e-3}, .acceleration = {1e-3}};
  SlidingWindow target = target_of(1, sine, 5, limits);
  for (const int least : {1, 2, 9, 10, 11}) {
    const From from = at_rest(milliseconds(200), {5});
    EntrySearch search(1, {});
    const Found found = look_for(search, target, from,
                                 {.limits = &limits, .least = Time(least), .may_end_ahead = true});
    EXPECT_EQ(found.outcome, Outcome::none) << least;
  }
}

TEST(EntrySearch, EntersTheExtrapolationIfTheLimitsAllowNoKnot) {
  const MotionLimits limits{.acceleration = {4}};
  SlidingWindow target = target_of(1, sine, 5, limits);
  const From from = at_rest(milliseconds(90), {sine(0.09, 0) - 0.5});
  EntrySearch search(1, {});
  const Found at_knots = look_for(search, target, from, {.limits = &limits});
  EXPECT_EQ(at_knots.outcome, Outcome::none);
  const Found found = look_for(search, target, from, {.limits = &limits, .may_end_ahead = true});
  ASSERT_EQ(found.outcome, Outcome::found);
  EXPECT_FALSE(found.end.knot);
  EXPECT_EQ(found.end.known, 5U);
  EXPECT_GT(found.end.state.time, target.time(4));
  EXPECT_LE(found.end.state.time - from.time, EntrySearch::kLongest);
  Extrapolation extrapolation(1);
  extrapolation.begin(target);
  EXPECT_EQ(found.end.line_end, extrapolation.line_end());
  EXPECT_EQ(found.end.rest, extrapolation.rest());
  State at(1);
  extrapolation.state_at(found.end.state.time, at.ref());
  EXPECT_EQ(found.end.state.position[0], at.position()[0]);
  EXPECT_EQ(found.end.state.velocity[0], at.velocity()[0]);
  EXPECT_EQ(found.end.state.acceleration[0], at.acceleration()[0]);
  expect_leads(found.entry, from, found.end.state);
  EXPECT_LE(peak(found.entry, 1, 0, 2), 4 * (1 + 1e-9));
}

TEST(EntrySearch, FallsBackToTheFirstReachableKnotIfTheTargetAfterItExceedsTheLimits) {
  // The jump at the end of the target exceeds the limits, whichever knot the entry ends at.
  const Motion jumps = [](double s, std::size_t) { return s < 0.29 ? 0.1 * s : 5.0; };
  const MotionLimits limits{.acceleration = {10}};
  SlidingWindow target = target_of(1, jumps, 11, limits);
  const From from = at_rest(milliseconds(50), {0.005});
  EntrySearch search(1, {});
  const Found at_knots = look_for(search, target, from, {.limits = &limits});
  EXPECT_EQ(at_knots.outcome, Outcome::none);
  const Found found = look_for(search, target, from, {.limits = &limits, .may_end_ahead = true});
  if (found.end.knot) {
    ASSERT_EQ(found.outcome, Outcome::found);
    EXPECT_TRUE(keeps_within(limits, nullptr, found.entry));
    for (std::size_t k = target.oldest_segment(); k < *found.end.knot; ++k) {
      EXPECT_FALSE(keeps_within(limits, nullptr, quintic_to(target, from, k))) << k;
    }
  } else {
    ADD_FAILURE() << "the entry ends after the jump";
  }
}

TEST(EntrySearch, PrefersALaterKnotAfterWhichTheTargetKeepsTheLimits) {
  // A hump that exceeds the limits at the beginning, then rest.
  const Motion hump = [](double s, std::size_t) { return s > 0.13 && s < 0.15 ? 0.02 : 0.0; };
  const MotionLimits limits{.acceleration = {10}};
  SlidingWindow target = target_of(1, hump, 9, limits, milliseconds(40));
  const From from = at_rest(milliseconds(50), {0});
  EntrySearch search(1, {});
  const EntryRules rules{.limits = &limits, .may_end_ahead = true};
  const Found found = look_for(search, target, from, rules);
  ASSERT_EQ(found.outcome, Outcome::found);
  Segment segment(1);
  for (std::size_t i = found.end.knot.value_or(8); i + 1 < target.knots(); ++i) {
    target.segment(i, segment);
    EXPECT_TRUE(keeps_within(limits, nullptr, segment)) << i;
  }
  target.segment(0, segment);
  EXPECT_FALSE(keeps_within(limits, nullptr, segment));
}

TEST(EntrySearch, FindsTheSameEntryForAnyNumberOfTriesPerCall) {
  std::mt19937_64 random(6);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (int i = 0; i < 100; ++i) {
    const MotionLimits limits{.velocity = {1.5}, .acceleration = {3.0 + 10 * (i % 3)}};
    SlidingWindow target = target_of(1, sine, 3 + i % 8, limits);
    From from = at_rest(milliseconds(80), {sine(0.08, 0) + 0.3 * unit(random)});
    from.velocity[0] = unit(random);
    const EntryRules rules{.limits = &limits, .may_end_ahead = true};
    EntrySearch search(1, {});
    const Found whole = look_for(search, target, from, rules);
    for (const int at_once : {1, 2, 4}) {
      const Found parts = look_for(search, target, from, rules, at_once);
      EXPECT_EQ(parts.outcome, whole.outcome) << i;
      EXPECT_EQ(parts.tried, whole.tried) << i;
      EXPECT_EQ(parts.end.knot, whole.end.knot) << i;
      if (whole.outcome != Outcome::found) continue;
      EXPECT_EQ(parts.end.state.time, whole.end.state.time) << i;
      EXPECT_EQ(parts.entry.coefficients, whole.entry.coefficients) << i;
    }
  }
}

TEST(EntrySearch, TriesNothingIfNoTryIsLeft) {
  const MotionLimits limits{.acceleration = {10}};
  SlidingWindow target = target_of(1, sine, 9, limits);
  const From from = at_rest(milliseconds(90), {sine(0.09, 0)});
  EntrySearch search(1, {});
  search.restart(0);
  int tries = 0;
  const EntryRules rules{.limits = &limits, .may_end_ahead = true};
  EXPECT_EQ(search.search(target, from.instant(), rules, tries), Outcome::more);
  EXPECT_EQ(tries, 0);
}

TEST(EntrySearch, SpendsNoTryOnKnotsThatAreOutOfReach) {
  const MotionLimits limits{.acceleration = {1}};
  SlidingWindow target = target_of(1, sine, 9, limits);
  const From from = at_rest(milliseconds(90), {sine(0.09, 0) + 50});
  EntrySearch search(1, {});
  const Found found = look_for(search, target, from, {.limits = &limits});
  EXPECT_EQ(found.outcome, Outcome::none);
  EXPECT_EQ(found.tried, 0);
}

TEST(EntrySearch, TakesAKnotOnlyAfterTheRequiredNumberOfNewerKnotsIsKnown) {
  const MotionLimits none;
  const EntryRules rules{.limits = &none, .newer = 8};
  SlidingWindow target(1, {});
  target.begin_run();
  const From from = at_rest(milliseconds(90), {sine(0.09, 0)});
  EntrySearch search(1, {});
  search.restart(0);
  for (int i = 0; i <= 8; ++i) {
    const double x = sine(0.1 + 0.02 * i, 0);
    target.append({.time = milliseconds(100 + 20 * i), .position = {&x, 1}});
    int tries = kAny;
    const Outcome outcome = search.search(target, from.instant(), rules, tries);
    EXPECT_EQ(outcome, i < 8 ? Outcome::none : Outcome::found) << i;
    EXPECT_EQ(tries, i < 8 ? kAny : kAny - 1) << i;
  }
  EXPECT_EQ(search.end().knot, 0U);
  EXPECT_EQ(search.end().known, 9U);
}

TEST(EntrySearch, ConsidersOnlyNewKnotsUntilItIsRestarted) {
  const MotionLimits limits{.acceleration = {10}};
  SlidingWindow target = target_of(1, sine, 4, limits);
  const From from = at_rest(milliseconds(90), {sine(0.09, 0) - 0.5});
  EntrySearch search(1, {});
  const EntryRules rules{.limits = &limits};
  EXPECT_EQ(look_for(search, target, from, rules).outcome, Outcome::none);
  // The search would reach the first knot from this state, if it considered that knot.
  From near = from;
  near.position[0] = sine(0.06, 0);
  near.velocity[0] = 1;
  near.time = milliseconds(60);
  int tries = kAny;
  EXPECT_EQ(search.search(target, near.instant(), rules, tries), Outcome::none);
  search.restart(0);
  EXPECT_EQ(search.search(target, near.instant(), rules, tries), Outcome::found);
  EXPECT_EQ(search.end().knot, 0U);
}

}  // namespace
}  // namespace splinecast::core::entries
