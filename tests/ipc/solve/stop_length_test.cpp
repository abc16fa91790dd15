#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "core/forms/stop.hpp"
#include "tests/fixtures/streams/watched_stream.hpp"

/// How long stops take, and with which acceleration they and entries begin.
namespace splinecast::ipc::entries {
namespace {

/// A sine of amplitude 1 that begins at rest at −1.
double sine(int ms) { return -std::cos(1.5 * (ms - 50) / 1e3); }

core::WindowOptions bounded_sine(double acceleration) {
  core::WindowOptions how = limited(acceleration);
  how.limits.lower = {-1};
  how.limits.upper = {1};
  return how;
}

/// The number of revisions of which the stop rests outside the bounds.
int revisions_outside(Watched& live) {
  int outside = 0;
  Word seen = 0;
  for (int ms = 50; ms <= 5000; ms += 20) {
    live.run_to(ms - 100);
    live.send(ms, sine(ms));
    live.step();
    const Summary& summary = live.solver.summary();
    if (summary.revision == seen) continue;
    seen = summary.revision;
    outside += std::abs(live.position_at(at(60'000))) > 1 + 1e-6 ? 1 : 0;
  }
  return outside;
}

TEST(StopLength, KeepsTheBoundsOfASineThatTouchesThem) {
  Watched live(bounded_sine(100));
  EXPECT_EQ(revisions_outside(live), 0);
  live.run_to(6000);
  EXPECT_EQ(live.verified(), "");
}

TEST(StopLength, IsTheStopTimeWithoutALimitOfAcceleration) {
  core::WindowOptions how = bounded_sine(0);
  how.limits.acceleration.clear();
  Watched live(how);
  EXPECT_GT(revisions_outside(live), 10);
  EXPECT_EQ(live.solver.summary().stop, how.stop_length);
  live.run_to(6000);
  EXPECT_EQ(live.verified(), "");
}

/// A stream whose source ends shortly before the bound.
void stop_before_bound(Watched& live) {
  for (int ms = 50; ms <= 2000; ms += 20) {
    live.run_to(ms - 100);
    live.send(ms, sine(ms));
  }
  live.run_to(4000);
}

TEST(StopLength, ShortenedByABoundIsADecisionThatVerificationChecks) {
  Watched live(bounded_sine(100));
  stop_before_bound(live);
  live.end();
  EXPECT_EQ(live.verified(), "");
  const auto segments = live.collected.segments();
  const auto stop = std::ranges::find(segments, SegmentKind::stop, &SegmentCopy::kind);
  ASSERT_NE(stop, segments.end());
  EXPECT_LT(stop->right - stop->left, live.window.stop_length);
  EXPECT_LE(live.position_at(at(60'000)), 1 + 1e-12);
  live.window.limits.upper = {2};
  EXPECT_NE(live.verified().find("too short"), std::string::npos) << live.verified();
  live.window.limits.upper = {0.99};
  EXPECT_NE(live.verified().find("bounds"), std::string::npos) << live.verified();
  live.window.limits = {.acceleration = {0.1}};
  EXPECT_NE(live.verified().find("limits"), std::string::npos) << live.verified();
}

}  // namespace
}  // namespace splinecast::ipc::entries
