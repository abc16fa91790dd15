#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "core/motion/extrapolation.hpp"
#include "tests/fixtures/streams/watched_stream.hpp"

/// How a curve returns to its waypoints, and which waypoints it passes over.
namespace splinecast::ipc::entries {
namespace {

TEST(Entry, ReturnsToTheWaypointsAfterAStarvationAndPassesOverThoseBeforeItsEnd) {
  for (const double limit : {0.0, 3.0, 10.0}) {
    SCOPED_TRACE(limit);
    Watched live(limited(limit));
    live.send_all(50, 500, 60);
    live.run_to(700);
    EXPECT_TRUE(live.solver.summary().starved);
    EXPECT_EQ(live.course(), Course::waiting);
    EXPECT_EQ(live.solver.summary().underruns, 1U);
    live.send_all(800, 2500, 300);
    EXPECT_FALSE(live.solver.summary().starved);
    EXPECT_EQ(live.course(), Course::on_target);
    for (int ms = 2300; ms <= 2500; ms += 10) {
      EXPECT_NEAR(live.position_at(at(ms)), motion(at(ms)), 1e-12) << ms;
    }
    const Summary& summary = live.solver.summary();
    EXPECT_EQ(summary.refused, 0U);
    EXPECT_EQ(summary.knots, live.sent.size());
    EXPECT_GT(summary.passed_over, 0U);
    EXPECT_GE(live.entries(), 1U);
    live.end();
    EXPECT_EQ(live.met(), live.solver.summary().interpolated());
    expect_continuous(live);
    EXPECT_EQ(live.verified(), "");
    if (limit > 0) {
      EXPECT_LE(live.peak(2), limit * (1 + 1e-6));
    }
  }
}

TEST(Entry, CountsNoWaypointAsPassedOverIfTheCurveInterpolatesAll) {
  Watched live;
  live.send_all(50, 1000, 150);
  live.end();
  EXPECT_EQ(live.solver.summary().passed_over, 0U);
  EXPECT_EQ(live.solver.summary().interpolated(), live.sent.size());
  EXPECT_EQ(live.met(), live.sent.size());
  EXPECT_EQ(live.verified(), "");
}

TEST(Entry, EndsAtTheFirstWaypointThatItsLimitsAllow) {
  Watched live(limited(8));
  live.send_all(50, 300, 60);
  live.run_to(600);  // at rest past x(0.3)
  const double rest = live.position_at(at(600));
  // All in one step, in the future and at a distance of 0.05 from the rest position.
  for (int ms = 650; ms <= 1500; ms += 10) live.send(ms, rest + 0.05);
  live.drain();
  live.note();
  ASSERT_EQ(live.course(), Course::entering);
  const Summary& summary = live.solver.summary();
  EXPECT_GT(summary.passed_over, 0U);
  live.run_to(1510);
  // From rest to rest over 0.05 with an acceleration of at most 8 takes at least 0.19 s.
  const double least = std::sqrt(10 / std::sqrt(3.0) * 0.05 / 8);
  const auto entry =
      std::ranges::find(live.collected.segments(), SegmentKind::entry, &SegmentCopy::kind);
  ASSERT_NE(entry, live.collected.segments().end());
  const double took = to_seconds(entry->right - entry->left);
  EXPECT_GE(took, least - 1e-6);
  EXPECT_LE(took, least + 0.02 + 1e-6);  // at most two knot intervals longer
  EXPECT_LE(live.peak(2), 8 * (1 + 1e-6));
}

TEST(Entry, WithoutAReachableWaypointContinuesAlongALineToAStop) {
  Watched live(limited(2));
  live.send_all(50, 300, 60);
  live.run_to(800);
  live.send(900);
  live.send(910);
  live.send(920);
  live.drain();
  live.note();
  ASSERT_EQ(live.course(), Course::ahead);
  EXPECT_EQ(live.solver.summary().passed_over, 3U);
  // At this time the extrapolation line from the newest waypoint ends.
  const Time line_end = at(920) + core::Extrapolation::kLineLength;
  State end(1);
  EXPECT_TRUE(has_values(live.sampler.preview(line_end, end.ref())));
  live.run_to(3000);
  EXPECT_EQ(live.sampler.sample(at(2900), live.state.ref()), SampleStatus::holding);
  EXPECT_LE(live.peak(2), 2 * (1 + 1e-6));
  expect_continuous(live);
  EXPECT_EQ(live.verified(), "");
}

TEST(Entry, BeyondTheNewestWaypointIsReplannedForNewerOnesUntilItReachesOne) {
  Watched live(limited(2));
  live.send_all(50, 300, 60);
  live.run_to(800);
  live.send_all(860, 3500, 60);
  EXPECT_TRUE(live.course() == Course::on_target);
  live.end();
  EXPECT_EQ(live.met(), live.solver.summary().interpolated());
  EXPECT_GT(live.solver.summary().interpolated(), 40U);
  EXPECT_LE(live.peak(2), 2 * (1 + 1e-6));
  EXPECT_EQ(live.verified(), "");
}

/// Only the jerk limit excludes the early candidates, which are more than one step may try.
TEST(Entry, IsFoundByASearchOfAnyNumberOfSteps) {
  core::WindowOptions how;
  how.limits = {.acceleration = {10}, .jerk = {15}};
  Watched live(how);
  for (int ms = 100; ms <= 300; ms += 10) {
    live.run_to(ms - 60);
    live.send(ms, 0);
  }
  live.run_to(800);
  ASSERT_EQ(live.course(), Course::waiting);
  for (int ms = 900; ms <= 4000; ms += 10) {
    live.run_to(ms - 100);
    live.send(ms, 0.1);
  }
  EXPECT_EQ(live.course(), Course::on_target);
  EXPECT_NEAR(live.position_at(at(4000)), 0.1, 1e-12);
}

/// If every new waypoint replaced the entry by one that ends later, the curve would never reach its
/// waypoints.
TEST(Entry, EndsWithinSecondsAlthoughAWaypointArrivesEveryTenMilliseconds) {
  for (const double limit : {3.0, 10.0}) {
    SCOPED_TRACE(limit);
    Watched live(limited(limit));
    live.send_all(50, 500, 60);
    live.run_to(700);
    live.send_all(800, 2200, 80);
    EXPECT_EQ(live.course(), Course::on_target);
    EXPECT_NEAR(live.position_at(at(2200)), motion(at(2200)), 1e-12);
  }
}

TEST(Entry, ThatEndsAtAWaypointIsNotChangedByLaterWaypoints) {
  Watched live(limited(8));
  live.send_all(50, 300, 60);
  live.run_to(600);
  for (int ms = 650; ms <= 1200; ms += 10) live.send(ms, 0.1);
  live.step();
  live.drain();
  ASSERT_EQ(live.course(), Course::entering);
  live.run_to(610);  // the entry has begun
  const double on_the_way = live.position_at(at(660));
  const Word passed = live.solver.summary().passed_over;
  for (int ms = 1210; ms <= 1250; ms += 10) live.send(ms, 0.1 + 0.01 * (ms - 1200));
  live.drain();
  EXPECT_EQ(live.position_at(at(660)), on_the_way);
  EXPECT_EQ(live.solver.summary().passed_over, passed);
}

}  // namespace
}  // namespace splinecast::ipc::entries
