#include <gtest/gtest.h>

#include <chrono>
#include <optional>
#include <vector>

#include "tests/fixtures/curves/plan_walk.hpp"

namespace splinecast::testing {
namespace {

TEST(Plan, KeepsItsInvariantsInRandomOperations) {
  constexpr std::uint64_t kOperations = 100'000;
  PlanFacts facts;
  for (std::uint64_t seed = 1; facts.operations < kOperations; ++seed) {
    PlanWalk(seed, facts).run(seed % 3 == 0 ? 150 : 20);
  }
  EXPECT_EQ(facts.violations(), 0U);
  for (const std::string& violation : facts.first) ADD_FAILURE() << violation;
  EXPECT_TRUE(facts.missing().empty()) << facts.missing().front();
  EXPECT_TRUE(facts.unexpected().empty()) << facts.unexpected().front();
  EXPECT_GT(facts.entries_checked, 0U);
  EXPECT_GT(facts.stops_checked, 0U);
}

using std::chrono::milliseconds;

const std::vector<double> zero{0};

/// A plan whose entry ends at the last of three waypoints, at 300 ms; two later ones wait.
core::Plan entered_at_newest() {
  core::Plan plan(1, {});
  plan.begin({milliseconds(0), zero, zero, zero});
  for (const int ms : {100, 200, 300}) {
    (void)plan.append({.time = milliseconds(ms), .position = zero});
  }
  plan.enter({.known = 3,
              .state = {milliseconds(300), zero, zero, zero},
              .line_end = milliseconds(550),
              .rest = milliseconds(800)},
             std::nullopt);
  EXPECT_EQ(plan.passed_over(), 2U);
  (void)plan.append({.time = milliseconds(1000), .position = zero});
  (void)plan.append({.time = milliseconds(1100), .position = zero});
  return plan;
}

TEST(Plan, AnEntryThatEndsAtTheNewestWaypointMeetsItAlsoIfAnotherEntryFollows) {
  core::Plan plan = entered_at_newest();
  plan.enter({.knot = 4, .known = 5, .state = {milliseconds(1100), zero, zero, zero}},
             Instant{milliseconds(900), zero, zero, zero});
  EXPECT_EQ(plan.passed_over(), 3U);  // 0, 1 and 3
  EXPECT_EQ(plan.unmet(), 3U);
}

TEST(Plan, AnEntryThatEndsAtTheNewestWaypointMeetsItAlsoIfAnEndFollows) {
  core::Plan entered = entered_at_newest();
  entered.end_by_entry(milliseconds(1200), Instant{milliseconds(900), zero, zero, zero});
  EXPECT_EQ(entered.passed_over(), 3U);  // 0, 1 and 3; it ends at 4
  core::Plan rests = entered_at_newest();
  rests.end_at_newest();
  EXPECT_EQ(rests.passed_over(), 3U);
}

/// The pieces that end a curve are executed at the largest rate of a law, too.
TEST(PlanSearch, ComparesAnEndWithTheLimitsAtTheLargestRate) {
  core::WindowOptions how;
  how.max_rate = 2;
  how.limits = {.velocity = {1}, .acceleration = {4}, .jerk = {40}};
  core::Plan plan(1, how);
  core::PlanSearch search(1, how, {.is_live = true});
  for (int i = 0; i < 5; ++i) {
    const double x = 0.001 * i;
    (void)plan.append({.time = milliseconds(10 * i), .position = {&x, 1}});
  }
  const core::ShownLimits shown(1);
  (void)search.keeps_limits_with(plan, {.kind = ConditionKind::halt, .value = {}}, milliseconds(0),
                                 shown.limits());
  EXPECT_EQ(search.end_limits().velocity, std::vector<double>{0.5});
  EXPECT_EQ(search.end_limits().acceleration, std::vector<double>{1});
  EXPECT_EQ(search.end_limits().jerk, std::vector<double>{5});
}

}  // namespace
}  // namespace splinecast::testing
