#include <gtest/gtest.h>

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

#include "ipc/verification/verify.hpp"
#include "tests/fixtures/curves/method_trial.hpp"
#include "tests/fixtures/streams/live_world.hpp"

namespace splinecast::ipc {
namespace {

std::string difference_of(const Verification& found) {
  if (!found.first) return "";
  return std::to_string(found.first->segment) + ": " + found.first->what + ", " +
         found.first->published + " published, " + found.first->solved + " solved";
}

/// The starts from which parts have been verified.
struct Starts {
  std::size_t restarts = 0;
  std::size_t entries = 0;
  std::size_t held = 0;  ///< times that a stopper held a stream
};

/// A live world with kills, starvation and, mostly, replacements.
testing::WorldOptions world_options(const char* method, std::uint64_t seed) {
  core::WindowOptions window = testing::plain_window(*find_method(method));
  window.interpolant.lambda = method == std::string("smoothing") ? 1e-9 : 0;
  return {.seed = seed,
          .dimensions = 1 + seed % 3,
          .window = window,
          .starts_in_motion = seed % 2 == 0,
          .starvations = 1,
          .replacements = seed % 3 == 0 ? 0.0 : 3.0,
          .solver_kills = 2,
          .producer_kills = 2,
          .pauses = 2,
          .has_limits = seed % 4 < 2};
}

/// Runs a world and verifies it from each of its starts.
void verify_parts_of(const testing::WorldOptions& options, const std::string& name, Starts& found) {
  testing::LiveWorld world(options);
  world.run(std::chrono::milliseconds(1500));
  // A smoothed curve ends near its last waypoint: finish() expects it to end there.
  if (options.seed % 2 == 0 && options.window.interpolant.lambda == 0) world.finish();
  if (options.seed % 2 == 1 && options.stoppers > 0) world.finish_held();
  const Verification whole = world.verify();
  EXPECT_EQ(difference_of(whole), "") << name << ", seed " << options.seed;
  found.held += world.held;
  for (const auto& start : world.starts()) {
    const Verification part = world.verify_from(start);
    ASSERT_EQ(difference_of(part), "")
        << name << ", seed " << options.seed << ", from " << start.segment
        << (start.restart ? ", restart" : ", entry");
    EXPECT_EQ(part.equal + start.segment + 1, whole.equal);
    ++(start.restart ? found.restarts : found.entries);
  }
}

TEST(VerificationOfParts, IsBitForBitFromEveryRestartAndEntry) {
  Starts found;
  for (const char* name : {"c2", "akima", "pchip", "bessel", "smoothing", "hermite", "quintic"}) {
    for (std::uint64_t seed = 1; seed <= 12 && !::testing::Test::HasFailure(); ++seed) {
      verify_parts_of(world_options(name, seed), name, found);
    }
  }
  EXPECT_GT(found.restarts, 1000U);
  EXPECT_GT(found.entries, 20U);
}

TEST(VerificationOfParts, IsBitForBitWithPeriodicAndQuaternionDimensions) {
  const Dimension angle{.kind = DimensionKind::periodic, .period = 0.7};
  const Dimension rotation{.kind = DimensionKind::quaternion};
  const Dimension w_first{.kind = DimensionKind::quaternion_wxyz};
  Starts found;
  for (const auto& kinds : {std::vector<Dimension>{angle, {}},
                            {angle, rotation, rotation, rotation, rotation},
                            {w_first, w_first, w_first, w_first}}) {
    for (const char* name : {"c2", "pchip", "hermite", "quintic"}) {
      for (std::uint64_t seed = 1; seed <= 6 && !::testing::Test::HasFailure(); ++seed) {
        testing::WorldOptions options = world_options(name, seed);
        options.dimensions = kinds.size();
        options.kinds = kinds;
        verify_parts_of(options, name, found);
      }
    }
  }
  EXPECT_GT(found.restarts, 500U);
  EXPECT_GT(found.entries, 10U);
}

TEST(VerificationOfParts, IsBitForBitWhenStoppersHoldTheStream) {
  Starts found;
  for (const char* name : {"c2", "pchip", "smoothing", "hermite", "quintic"}) {
    for (std::uint64_t seed = 1; seed <= 24 && !::testing::Test::HasFailure(); ++seed) {
      testing::WorldOptions options = world_options(name, seed);
      options.stoppers = 3;
      verify_parts_of(options, name, found);
    }
  }
  EXPECT_GT(found.held, 100U);
  EXPECT_GT(found.restarts, 500U);
  EXPECT_GT(found.entries, 10U);
}

}  // namespace
}  // namespace splinecast::ipc
