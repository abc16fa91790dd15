#include <gtest/gtest.h>

#include <chrono>
#include <cstdint>
#include <string>

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

/// Verifies from every start of live worlds with kills, starvation and replacements.
TEST(VerificationOfParts, IsBitForBitFromEveryRestartAndEntry) {
  std::size_t restarts = 0;
  std::size_t entries = 0;
  for (const char* name : {"c2", "akima", "pchip", "bessel", "smoothing"}) {
    core::WindowOptions window = testing::plain_window(*find_method(name));
    window.interpolant.lambda = name == std::string("smoothing") ? 1e-9 : 0;
    for (std::uint64_t seed = 1; seed <= 12 && !::testing::Test::HasFailure(); ++seed) {
      testing::LiveWorld world({.seed = seed,
                                .dimensions = 1 + seed % 3,
                                .window = window,
                                .starts_in_motion = seed % 2 == 0,
                                .starvations = 1,
                                .replacements = seed % 3 == 0 ? 0.0 : 3.0,
                                .solver_kills = 2,
                                .producer_kills = 2,
                                .pauses = 2,
                                .has_limits = seed % 4 < 2});
      world.run(std::chrono::milliseconds(1500));
      // A smoothed curve ends near its last waypoint: finish() expects it to end there.
      if (seed % 2 == 0 && window.interpolant.lambda == 0) world.finish();
      const Verification whole = world.verify();
      for (const auto& start : world.starts()) {
        const Verification found = world.verify_from(start);
        ASSERT_EQ(difference_of(found), "")
            << name << ", seed " << seed << ", from " << start.segment
            << (start.restart ? ", restart" : ", entry");
        EXPECT_EQ(found.equal + start.segment + 1, whole.equal);
        ++(start.restart ? restarts : entries);
      }
    }
  }
  EXPECT_GT(restarts, 1000U);
  EXPECT_GT(entries, 20U);
}

}  // namespace
}  // namespace splinecast::ipc
