#include <gtest/gtest.h>

#include <algorithm>

#include "tests/fixtures/streams/live_world.hpp"

namespace splinecast::ipc {
namespace {

using std::chrono::seconds;
using testing::LiveWorld;
using testing::WorldOptions;

/// Conditions that hold after any faults. Positions are of order 1, velocities of order 10,
/// accelerations of order 100.
void expect_trusted(const LiveWorld& world, std::uint64_t seed) {
  const auto& report = world.report();
  EXPECT_EQ(report.changed, 0U) << "seed " << seed;
  // A controller's sample at `now` has settled, unless the solver is paused.
  EXPECT_LE(report.unsettled, world.pauses * 200) << "seed " << seed;
  EXPECT_LT(report.position_step, 1e-11) << "seed " << seed;
  EXPECT_LT(report.velocity_step, 1e-9) << "seed " << seed;
  EXPECT_LT(report.unpublished_step, 1e-5) << "seed " << seed;
  // A solver that is paused before the start has settled cannot improve the published start.
  EXPECT_LE(report.acceleration, (world.pauses > 0 ? 15 : 10) * world.ideal_peak())
      << "seed " << seed;
  const Summary& summary = world.summary();
  // No item is lost silently, regardless of kills.
  EXPECT_EQ(summary.consumed,
            summary.knots + summary.refused + summary.withdrawn + summary.controls)
      << "seed " << seed;
  EXPECT_EQ(summary.consumed, world.items()) << "seed " << seed;
}

/// Solves again from the same items with the recorded decisions, and expects the bits of every
/// settled segment.
void expect_verified(const LiveWorld& world, std::uint64_t seed) {
  const Verification found = world.verify();
  EXPECT_GT(found.equal, 0U) << "seed " << seed;
  EXPECT_FALSE(found.first) << "seed " << seed << ", segment " << found.first->segment << ", "
                            << found.first->what << ": " << found.first->published << " published, "
                            << found.first->solved << " solved";
}

/// Each waypoint arrives when the previous one is frozen, so that the curve is always in an entry
/// to its waypoints, within its limits.
TEST(LiveContract, StaysNearTheMotionAtADepthOfOneKnot) {
  for (std::uint64_t seed = 1; seed < 20; ++seed) {
    LiveWorld world({.seed = seed, .starts_in_motion = true, .max_lead_knots = 1});
    world.run(seconds(5));
    EXPECT_LT(world.report().acceleration, 10 * world.ideal_peak()) << "seed " << seed;
    EXPECT_EQ(world.summary().refused, 0U);
    world.finish();
    expect_trusted(world, seed);
    expect_verified(world, seed);
    EXPECT_EQ(world.sent, world.interpolated + world.passed_over);
    EXPECT_GT(world.interpolated, world.sent / 4) << "seed " << seed;
    // No segment begins at the end of the curve.
    EXPECT_LE(world.passed_over, world.summary().passed_over + 1) << "seed " << seed;
  }
}

/// All faults together, for 1.5 s in each of many worlds.
TEST(LiveContract, HoldsInThousandsOfShortWorlds) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  constexpr std::uint64_t kSeeds = 60;
#else
  constexpr std::uint64_t kSeeds = 2000;
#endif
  for (std::uint64_t seed = 1; seed <= kSeeds && !HasFailure(); ++seed) {
    const bool is_calm = seed % 4 == 0;
    LiveWorld world({.seed = seed,
                     .dimensions = 1 + seed % 3,
                     .starts_in_motion = seed % 2 == 0,
                     .starvations = is_calm ? 0 : 1.0,
                     .replacements = is_calm ? 0 : 3.0,
                     .solver_kills = 2,
                     .producer_kills = 2,
                     .pauses = is_calm ? 0 : 2.0});
    world.run(std::chrono::milliseconds(1500));
    world.finish();
    expect_trusted(world, seed);
    expect_verified(world, seed);
  }
}

TEST(LiveContract, HoldsThroughHalfAMinuteOfFaults) {
  LiveWorld world({.seed = 1,
                   .starts_in_motion = true,
                   .starvations = 2,
                   .replacements = 4,
                   .solver_kills = 1.1,
                   .producer_kills = 1.1,
                   .pauses = 0.8});
  world.run(seconds(30));
  world.finish();
  expect_trusted(world, 1);
  expect_verified(world, 1);
  EXPECT_GE(world.starved, 20U);
  EXPECT_GE(world.replaced, 50U);
  EXPECT_GE(world.solver_kills, 20U);
  EXPECT_GE(world.producer_kills, 20U);
  EXPECT_GE(world.pauses, 15U);
  EXPECT_GT(world.interpolated, 500U);
}

}  // namespace
}  // namespace splinecast::ipc
