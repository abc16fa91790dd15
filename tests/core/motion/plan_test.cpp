#include <gtest/gtest.h>

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

}  // namespace
}  // namespace splinecast::testing
