#include <gtest/gtest.h>

#include <chrono>
#include <cmath>

#include "tests/core/motion/entry_trial.hpp"

/// Entries that end at rest at the end of a stream.
namespace splinecast::core::entries {
namespace {

using std::chrono::hours;
using std::chrono::milliseconds;

TEST(EntrySearch, EndsTheEntryToRestAtItsOwnTimeIfTheLimitsAllow) {
  const MotionLimits limits{.acceleration = {10}};
  const From from = at_rest(milliseconds(100), {0});
  const From end = at_rest(milliseconds(600), {0.2});
  EntrySearch search(1, {});
  search.restart(0);
  int tries = kAny;
  ASSERT_EQ(search.search_rest(end.instant(), from.instant(), {.limits = &limits},
                               EntrySearch::kLongest, tries),
            Outcome::found);
  EXPECT_EQ(search.end().state.time, end.time);
  expect_leads(search.entry(), from, end.instant());
}

TEST(EntrySearch, DelaysTheEntryToRestByAtMostOneGrowthStepMoreThanTheLimitsRequire) {
  const MotionLimits limits{.acceleration = {10}};
  for (const double distance : {0.01, 0.2, 3.0, 1000.0}) {
    for (const int own : {-500, 0, 1, 30}) {  // ms; the first one is in the past
      const From from = at_rest(milliseconds(100), {0});
      const From end = at_rest(milliseconds(100 + own), {distance});
      EntrySearch search(1, {});
      Outcome outcome = Outcome::more;
      search.restart(0);
      const EntryRules rules{.limits = &limits, .least = milliseconds(5)};
      for (int i = 0; i < kAny && outcome == Outcome::more; ++i) {
        int tries = 4;
        outcome = search.search_rest(end.instant(), from.instant(), rules, hours(1), tries);
      }
      ASSERT_EQ(outcome, Outcome::found);
      const Segment& entry = search.entry();
      State state(1);
      const double length = to_seconds(entry.right - entry.left);
      evaluate(entry.order, entry.coefficients, length, state.ref());
      EXPECT_NEAR(state.position()[0], distance, 1e-9 * distance);
      EXPECT_LE(peak(entry, 1, 0, 2), 10 * (1 + 1e-9));
      // Rest to rest over x in T peaks at 10/√3 · x/T².
      const double least = std::sqrt(10 / std::sqrt(3.0) * distance / 10);
      EXPECT_GE(length, least * (1 - 1e-6));
      EXPECT_LE(length, least * EntrySearch::kGrowth * (1 + 1e-6)) << distance << ' ' << own;
    }
  }
}

TEST(EntrySearch, FindsNoEntryToRestRatherThanOneThatExceedsTheLimits) {
  const From end = at_rest(milliseconds(600), {1});
  const auto outcome = [&](const From& from, const MotionLimits& limits, Time longest) {
    EntrySearch search(1, {});
    search.restart(0);
    int tries = kAny;
    return search.search_rest(end.instant(), from.instant(), {.limits = &limits}, longest, tries);
  };
  const From moving{milliseconds(600), {1}, {1}, {0}};
  // It moves on from its place, which no entry can do without leaving the positions between.
  EXPECT_EQ(outcome(moving, {.lower = {0}, .upper = {1}}, hours(1)), Outcome::none);
  EXPECT_EQ(outcome(moving, {.acceleration = {10}}, hours(1)), Outcome::none);
  // The bound is before the waypoint; the time does not suffice.
  const From resting = at_rest(milliseconds(100), {0});
  EXPECT_EQ(outcome(resting, {.upper = {0.9}}, hours(1)), Outcome::none);
  EXPECT_EQ(outcome(resting, {.acceleration = {1e-3}}, milliseconds(3000)), Outcome::none);
  EXPECT_EQ(outcome(resting, {.acceleration = {1e-3}}, hours(1)), Outcome::found);
}

}  // namespace
}  // namespace splinecast::core::entries
