#include <gtest/gtest.h>

#include <chrono>

#include "ipc/sampling/sampler.hpp"
#include "tests/fixtures/streams/live_stream.hpp"

/// The settled time of a live stream, without and with a step of its solver.
namespace splinecast::ipc {
namespace {

using std::chrono::milliseconds;

using Live = testing::LiveStream;

TEST(LiveSolver, RaisesTheSettledTimeWithoutWaypointsOrRevisionsUntilTheMotionEnds) {
  Live live;
  live.put_all(50, 200);
  const auto settled = [&] { return live.board.reader.look().settled_until; };
  const Word revision = live.board.reader.revision();
  EXPECT_EQ(settled(), Live::kNow + milliseconds(5));
  EXPECT_EQ(live.solver.due(), Live::kNow + Time(2'500'000));
  EXPECT_FALSE(live.solver.step(live.clock).published);
  EXPECT_EQ(settled(), Live::kNow + milliseconds(5));
  live.clock.time += milliseconds(3);
  EXPECT_FALSE(live.solver.step(live.clock).published);
  EXPECT_EQ(settled(), Live::kNow + milliseconds(8));
  EXPECT_EQ(live.solver.summary().settled_until, settled());
  EXPECT_EQ(live.solver.due(), live.clock.time + Time(2'500'000));
  EXPECT_EQ(live.board.reader.revision(), revision);
  live.clock.time = Live::kNow + milliseconds(445);     // the stop segment ends at 450 ms
  EXPECT_TRUE(live.solver.step(live.clock).published);  // the stream has starved
  EXPECT_EQ(settled(), Live::kNow + milliseconds(450));
  EXPECT_EQ(live.solver.due(), Time::max());
  EXPECT_EQ(live.sampler.sample(Live::kNow + milliseconds(460), live.state.ref()),
            SampleStatus::holding);
}

TEST(LiveSolver, ItsNextStepKeepsTheSettledTimeRaisedWithoutAStep) {
  Live live;
  live.put_all(50, 200);
  const auto settled = [&] { return live.board.reader.look().settled_until; };
  SettledRaise raise = live.solver.settled_raise();
  EXPECT_TRUE(raise.raise(Live::kNow + milliseconds(20)));
  EXPECT_EQ(settled(), Live::kNow + milliseconds(25));
  EXPECT_TRUE(raise.raise(Live::kNow + milliseconds(10)));  // never decreases
  EXPECT_EQ(settled(), Live::kNow + milliseconds(25));
  live.clock.time += milliseconds(15);
  const Time early = settled() - Time(1);
  ASSERT_EQ(live.replace(settled(), {settled() + milliseconds(20)}), AppendStatus::accepted);
  live.drain();
  EXPECT_EQ(live.solver.summary().controls, 1U);
  EXPECT_GT(live.solver.summary().changed_from, early);
  EXPECT_EQ(settled(), Live::kNow + milliseconds(25));
}

TEST(LiveSolver, TheSettledTimeIsNotRaisedIfAStepHasWorkToDo) {
  Live live;
  EXPECT_FALSE(live.solver.settled_raise().raise(Live::kNow));  // no curve yet
  live.put_all(50, 200);
  const Time newest = live.solver.summary().newest_time;
  SettledRaise raise = live.solver.settled_raise();
  EXPECT_TRUE(raise.raise(newest - milliseconds(5) - Time(1)));
  EXPECT_FALSE(raise.raise(newest - milliseconds(5)));  // the stream starves at this time
  live.clock.time = newest - milliseconds(5);
  EXPECT_TRUE(live.solver.step(live.clock).published);
  EXPECT_TRUE(live.solver.summary().starved);
  EXPECT_FALSE(live.solver.settled_raise().raise(live.clock.time + milliseconds(1)));
}

TEST(LiveSolver, ASolverThatTakesOverContinuesFromTheLastSettledTime) {
  Live live;
  live.put_all(50, 200);
  live.clock.time += milliseconds(20);
  EXPECT_FALSE(live.solver.step(live.clock).published);
  const Time settled = Live::kNow + milliseconds(25);
  EXPECT_EQ(live.board.reader.look().settled_until, settled);
  live.replace_solver();
  EXPECT_EQ(live.solver.summary().settled_until, settled);
  // Also if the clock is earlier.
  live.clock.time = Live::kNow;
  live.drain();
  EXPECT_EQ(live.board.reader.look().settled_until, settled);
  EXPECT_EQ(live.replace(settled - Time(1), {settled + milliseconds(20)}), AppendStatus::too_late);
  ASSERT_EQ(live.replace(settled, {settled + milliseconds(20)}), AppendStatus::accepted);
  live.drain();
  EXPECT_EQ(live.solver.summary().controls, 1U);
  EXPECT_EQ(live.solver.summary().changed_from, settled);
}

}  // namespace
}  // namespace splinecast::ipc
