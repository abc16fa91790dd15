#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>

#include "tests/fixtures/streams/watched_stream.hpp"

/// Ends of live streams with limits.
namespace splinecast::ipc::entries {
namespace {

using std::chrono::seconds;

void expect_end_within(Watched& live, double limit) {
  EXPECT_LE(live.peak(2, true), limit * (1 + 1e-6));
  expect_continuous(live);
  EXPECT_EQ(live.verified(), "");
  const Summary& summary = live.solver.summary();
  EXPECT_EQ(summary.consumed,
            summary.knots + summary.refused + summary.withdrawn + summary.controls);
  EXPECT_EQ(live.met(), summary.knots - summary.passed_over);
  const Time end = summary.settled_until;
  EXPECT_EQ(live.sampler.preview(end + seconds(1), live.state.ref()), SampleStatus::holding);
  EXPECT_EQ(live.position_at(end + seconds(1)), live.position_at(end + seconds(1000)));
}

TEST(End, OfAMovingStreamBeginsAtTheLatestWaypointFromWhichItKeepsTheLimit) {
  for (const bool takes_over : {false, true}) {
    for (const double limit : {2.0, 5.0, 20.0}) {
      for (const int lead : {60, 400, 900}) {
        SCOPED_TRACE(::testing::Message() << "limit " << limit << ", lead " << lead);
        Watched live(limited(limit), takes_over);
        live.send_all(50, 1600, lead);  // its velocity is 1
        live.end();
        expect_end_within(live, limit);
        const Summary& summary = live.solver.summary();
        const double last = motion(at(1600));
        const double end = live.position_at(at(60'000));
        // At the velocity v, slowing down within T has the deceleration 1.5 v/T, on a way of v T/2.
        const double room = 1.0 * (lead - 10) / 1000;
        if (room > 0.9 / limit) {
          ASSERT_EQ(live.ending(), EndKind::slowed);
          EXPECT_EQ(summary.end_lateness, summary.settled_until - at(1600));
          EXPECT_LT(to_seconds(summary.end_lateness), 0.9 / limit);
          EXPECT_NEAR(end, last, 1e-9);
          EXPECT_EQ(summary.passed_over, 0U);
        } else if (room < 0.5 / limit) {
          ASSERT_EQ(live.ending(), EndKind::stopped);
          EXPECT_EQ(summary.end_lateness, Time::zero());
          EXPECT_EQ(summary.passed_over, 0U);
          EXPECT_GT(end, last);
          EXPECT_LE(end, last + std::max(0.25 / 2, 1.5 / limit / 2) + 1e-9);
        }
      }
    }
  }
}

TEST(End, ThatKeepsTheLimitsIsAsRequested) {
  Watched live(limited(5));
  live.send_all(50, 3190, 400);  // its velocity is 0.0001
  live.end();
  expect_end_within(live, 5);
  EXPECT_EQ(live.ending(), EndKind::as_requested);
  EXPECT_EQ(live.solver.summary().settled_until, at(3190));
  EXPECT_EQ(live.solver.summary().passed_over, 0U);
}

TEST(End, WithoutLimitsKeepsWhatTheMotionHasShown) {
  Watched live;
  live.send_all(50, 1600, 400);
  live.end();
  // A stop within the stop time from a velocity of 1 has more than the motion's own 1 /s².
  expect_end_within(live, 3 * 1.05 / 0.25);
  EXPECT_EQ(live.ending(), EndKind::slowed);
  EXPECT_LT(live.solver.summary().end_lateness, milliseconds(250));
}

TEST(End, IsKeptByASolverThatTakesOver) {
  Watched live(limited(10));
  live.send_all(50, 1600, 400);
  live.end();
  ASSERT_EQ(live.ending(), EndKind::slowed);
  const Summary before = live.solver.summary();
  live.replace_solver();
  live.step();
  const Summary& after = live.solver.summary();
  EXPECT_EQ(after.end_kind, before.end_kind);
  EXPECT_EQ(after.end_item, before.end_item);
  EXPECT_EQ(after.end_lateness, before.end_lateness);
  EXPECT_EQ(after.passed_over, before.passed_over);
  EXPECT_NEAR(live.position_at(at(60'000)), motion(at(1600)), 1e-9);
}

}  // namespace
}  // namespace splinecast::ipc::entries
