#include <gtest/gtest.h>

#include <chrono>
#include <vector>

#include "ipc/sampling/sampler.hpp"
#include "tests/fixtures/streams/live_stream.hpp"

/// Replacing the future of a live stream.
namespace splinecast::ipc {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

using Live = testing::LiveStream;

TEST(LiveSolver, ReplacesTheFutureInOneRevisionAndKeepsThePast) {
  Live live;
  live.put_all(50, 800);
  const Time t = Live::kNow + milliseconds(423);
  const double before = live.position_at(t - milliseconds(1));
  const Word revision = live.board.reader.revision();
  std::vector<Time> times;
  for (int ms = 20; ms <= 380; ms += 13) times.push_back(t + milliseconds(ms));
  ASSERT_EQ(live.replace(t, times), AppendStatus::accepted);
  EXPECT_TRUE(live.solver.step(live.clock).published);
  EXPECT_EQ(live.board.reader.revision(), revision + 1);
  EXPECT_EQ(live.solver.summary().changed_from, t);
  EXPECT_EQ(live.solver.summary().newest_time, times.back());
  EXPECT_EQ(live.position_at(t - milliseconds(1)), before);
  live.drain();
  const Summary& summary = live.solver.summary();
  EXPECT_EQ(static_cast<Course>(summary.course), Course::entering);
  for (std::size_t i = summary.passed_over; i < times.size(); ++i) {
    EXPECT_NEAR(live.position_at(times[i]), Live::x(times[i]), 1e-12) << i;
  }
  EXPECT_LT(summary.passed_over, times.size());
  EXPECT_EQ(live.sampler.preview(times.back() + milliseconds(7), live.state.ref()),
            SampleStatus::stopping);
}

TEST(LiveSolver, AnEmptyReplacementIsAStopSegment) {
  Live live;
  live.put_all(50, 500);
  const Time t = Live::kNow + milliseconds(250);
  ASSERT_EQ(live.replace(t, {}), AppendStatus::accepted);
  live.drain();
  EXPECT_EQ(live.sampler.preview(t, live.state.ref()), SampleStatus::stopping);
  EXPECT_NEAR(live.state.velocity()[0], Live::velocity(t), 1e-3);
  EXPECT_EQ(live.sampler.preview(t + milliseconds(251), live.state.ref()), SampleStatus::holding);
}

TEST(LiveSolver, ALateReplacementIsRefusedWithAllItsWaypoints) {
  Live live;
  live.put_all(50, 500);
  EXPECT_EQ(live.replace(Live::kNow + milliseconds(4), {Live::kNow + milliseconds(30)}),
            AppendStatus::too_late);
  const Time t = Live::kNow + milliseconds(10);
  ASSERT_EQ(live.replace(t, {t + milliseconds(20), t + milliseconds(30)}), AppendStatus::accepted);
  ASSERT_EQ(live.put(Live::kNow + milliseconds(510)), AppendStatus::accepted);
  live.clock.time += milliseconds(20);  // the solver wakes too late
  live.drain();
  EXPECT_EQ(live.reason(Refusal::too_late), 3U);
  EXPECT_EQ(live.solver.summary().newest_time, Live::kNow + milliseconds(510));
  EXPECT_NEAR(live.position_at(Live::kNow + milliseconds(400)),
              Live::x(Live::kNow + milliseconds(400)), 1e-12);
}

TEST(LiveSolver, KeepsItsHistoryAndWithdrawsItemsNotYetTaken) {
  Live live({.settle = 2}, 64, {.history = seconds(1)});
  live.put_all(50, 2050);
  const Summary& summary = live.solver.summary();
  EXPECT_LT(summary.newest, 65U);
  EXPECT_LT(summary.consumed, live.ring.writer.written());
  EXPECT_EQ(summary.first, 1U);
  EXPECT_FALSE(live.solver.step(live.clock).published);  // full: may not overwrite a knot
  const Time t = Live::kNow + milliseconds(300);
  ASSERT_EQ(live.replace(t, {}), AppendStatus::accepted);
  live.drain();
  EXPECT_EQ(summary.consumed, live.ring.writer.written());
  EXPECT_GT(summary.withdrawn, 100U);
  EXPECT_EQ(summary.consumed,
            summary.knots + summary.refused + summary.withdrawn + summary.controls);
  EXPECT_EQ(live.sampler.preview(t + milliseconds(300), live.state.ref()), SampleStatus::holding);
}

/// Some producers replace the future by each chunk of waypoints, including the first one.
TEST(LiveSolver, AReplacementOnAStreamWithoutWaypointsStartsIt) {
  for (const bool stops_first : {false, true}) {
    Live live;
    if (stops_first) {
      ASSERT_EQ(live.replace(Live::kNow, {}), AppendStatus::accepted);
      live.drain();
      EXPECT_EQ(live.solver.summary().newest, 0U);
    }
    Live appended;
    std::vector<Time> times;
    for (int ms = 50; ms <= 200; ms += 10) times.push_back(Live::kNow + milliseconds(ms));
    ASSERT_EQ(live.replace(Live::kNow + milliseconds(40), times), AppendStatus::accepted);
    live.drain();
    appended.put_all(50, 200);
    const Summary& summary = live.solver.summary();
    EXPECT_EQ(summary.refused, 0U);
    EXPECT_EQ(summary.controls, stops_first ? 2U : 1U);
    EXPECT_EQ(summary.knots, times.size());
    EXPECT_EQ(summary.consumed, summary.knots + summary.controls);
    for (int ms = 0; ms < 400; ++ms) {
      const Time t = Live::kNow + milliseconds(ms);
      EXPECT_EQ(live.position_at(t), appended.position_at(t)) << ms;
    }
  }
}

TEST(LiveSolver, AReplacementOnAStreamWithoutWaypointsWhoseFirstWaypointIsPastIsRefusedAsAWhole) {
  Live live;
  const Time first = Live::kNow + milliseconds(50);
  ASSERT_EQ(live.replace(first - milliseconds(10), {first, first + milliseconds(30)}),
            AppendStatus::accepted);
  live.clock.time = first;
  live.drain();
  EXPECT_EQ(live.reason(Refusal::past), 3U);
  EXPECT_EQ(live.solver.summary().knots, 0U);
  EXPECT_EQ(live.solver.summary().controls, 0U);
}

}  // namespace
}  // namespace splinecast::ipc
