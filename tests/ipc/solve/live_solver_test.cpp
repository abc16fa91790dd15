#include <gtest/gtest.h>

#include <chrono>
#include <vector>

#include "ipc/sampling/sampler.hpp"
#include "tests/fixtures/streams/live_stream.hpp"
#include "tests/ipc/solve/running_clock.hpp"

/// Which items a live stream takes and refuses, and how it starts, rests and finishes.
namespace splinecast::ipc {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

using Live = testing::LiveStream;

TEST(LiveSolver, RefusesOnlyWaypointsThatAreLaterThanTheMaximum) {
  Live live;
  live.put_all(50, 200);
  live.clock.time = Live::kNow + milliseconds(600);
  live.solver.step(live.clock);
  const Time settled = live.board.reader.look().settled_until;
  EXPECT_EQ(live.put(settled - kMostLate - Time(1)), AppendStatus::past);
  EXPECT_EQ(live.put(settled - kMostLate), AppendStatus::accepted);
  live.drain();
  EXPECT_EQ(live.solver.summary().refused, 0U);
  EXPECT_EQ(live.solver.summary().passed_over, 1U);
}

TEST(LiveSolver, AcceptsNearWaypointsAndEntersAgainAfterAStarvation) {
  Live live;
  live.put_all(50, 200);
  live.clock.time = Live::kNow + milliseconds(300);
  live.solver.step(live.clock);
  EXPECT_EQ(live.solver.summary().underruns, 1U);
  EXPECT_TRUE(live.solver.summary().starved);
  EXPECT_EQ(live.solver.summary().low_water, Time::zero());
  const double settled = live.position_at(Live::kNow + milliseconds(305));
  ASSERT_EQ(live.put(Live::kNow + milliseconds(250)), AppendStatus::accepted);  // late
  ASSERT_EQ(live.put(Live::kNow + milliseconds(307)), AppendStatus::accepted);  // too near
  for (int ms = 350; ms <= 900; ms += 10) {
    ASSERT_EQ(live.put(Live::kNow + milliseconds(ms)), AppendStatus::accepted);
  }
  live.drain();
  const Summary& summary = live.solver.summary();
  EXPECT_EQ(summary.refused, 0U);
  EXPECT_FALSE(summary.starved);
  EXPECT_EQ(static_cast<Course>(summary.course), Course::entering);
  EXPECT_GE(summary.passed_over, 1U);
  EXPECT_EQ(summary.interpolated() + summary.passed_over, summary.knots);
  EXPECT_EQ(summary.changed_from, Live::kNow + milliseconds(305));
  EXPECT_NEAR(live.position_at(Live::kNow + milliseconds(305)), settled, 1e-12);
  for (int ms = 850; ms <= 900; ms += 10) {
    const Time t = Live::kNow + milliseconds(ms);
    EXPECT_NEAR(live.position_at(t), Live::x(t), 1e-12);
  }
  EXPECT_EQ(summary.underruns, 1U);
}

TEST(LiveSolver, AFinishAfterASettledKnotReturnsToIt) {
  for (const int late : {0, 100, 500}) {  // frozen, in the stop segment, and at rest
    Live live;
    live.put_all(50, 600);
    const Time newest = Live::kNow + milliseconds(600);
    live.clock.time = newest - milliseconds(4) + milliseconds(late);
    live.solver.step(live.clock);
    live.finish({.kind = ConditionKind::halt, .value = {}});
    for (int i = 0; i < 100 && !live.solver.summary().finished; ++i) live.solver.step(live.clock);
    EXPECT_TRUE(live.solver.summary().finished);
    EXPECT_GT(live.solver.summary().changed_from, live.clock.time);
    const Time end = live.solver.summary().settled_until;
    EXPECT_GT(end, newest);  // after its time
    EXPECT_NEAR(live.position_at(end), Live::x(newest), 1e-12) << late;
    EXPECT_NEAR(live.position_at(end + seconds(5)), Live::x(newest), 1e-12) << late;
    EXPECT_EQ(live.sampler.preview(end + seconds(5), live.state.ref()), SampleStatus::holding);
    // The curve overshoots the knot and returns.
    const Time between = newest + (end - newest) / 2;
    EXPECT_GT(live.position_at(between), Live::x(newest));
  }
}

TEST(LiveSolver, StartsFromAGivenStateAndHasNoDataBeforeIt) {
  Live live;
  const Time t = Live::kNow + milliseconds(20);
  const std::vector<double> position{Live::x(t)};
  const std::vector<double> velocity{Live::velocity(t)};
  const std::vector<double> acceleration{Live::acceleration(t)};
  ASSERT_EQ(live.ring.writer.start_from({t, position, velocity, acceleration}, live.solved()),
            AppendStatus::accepted);
  EXPECT_EQ(live.ring.writer.start_from({t, position, velocity, acceleration}, live.solved()),
            AppendStatus::already_started);
  live.put_all(50, 200);
  EXPECT_EQ(live.sampler.sample(t - Time(1), live.state.ref()), SampleStatus::no_data);
  EXPECT_EQ(live.position_at(t), position[0]);
  EXPECT_EQ(live.state.velocity()[0], velocity[0]);
  EXPECT_EQ(live.state.acceleration()[0], acceleration[0]);
  EXPECT_NEAR(live.position_at(Live::kNow + milliseconds(35)),
              Live::x(Live::kNow + milliseconds(35)), 1e-5);
}

TEST(LiveSolver, DiscardsALateRevisionAndRepeatsIt) {
  Live live;
  live.put_all(50, 100);
  const Word revision = live.board.reader.revision();
  live.clock.time = Live::kNow + milliseconds(80);
  ASSERT_EQ(live.put(Live::kNow + milliseconds(110)), AppendStatus::accepted);
  const auto late = live.solver.step(RunningClock(live.clock.time, milliseconds(15)));
  EXPECT_TRUE(late.missed);
  EXPECT_FALSE(late.published);
  EXPECT_EQ(live.board.reader.revision(), revision);
  EXPECT_NEAR(live.position_at(Live::kNow + milliseconds(75)),
              Live::x(Live::kNow + milliseconds(75)), 1e-3);
  live.clock.time += milliseconds(2);
  EXPECT_EQ(live.solver.step(live.clock).consumed, 1U);
  EXPECT_EQ(live.solver.summary().deadline_misses, 1U);
  EXPECT_NEAR(live.position_at(Live::kNow + milliseconds(110)),
              Live::x(Live::kNow + milliseconds(110)), 1e-12);
}

TEST(LiveSolver, AStreamContinuesAfterARestLongerThanTheLargestInterval) {
  for (const bool replaces : {false, true}) {
    Live live;
    live.put_all(50, 200);
    live.clock.time = Live::kNow + std::chrono::seconds(1);
    EXPECT_TRUE(live.solver.step(live.clock).published);  // the last revision: the stream rests
    live.clock.time = Live::kNow + std::chrono::hours(2);
    EXPECT_FALSE(live.solver.step(live.clock).published);
    const Time t = live.clock.time + milliseconds(500);
    EXPECT_EQ(live.put(t + std::chrono::hours(1)), AppendStatus::too_far_apart);
    if (replaces) {
      const Time from = live.clock.time + milliseconds(20);
      EXPECT_EQ(live.replace(live.clock.time - Time(1), {t}), AppendStatus::too_late);
      ASSERT_EQ(live.replace(from, {t}), AppendStatus::accepted);
    } else {
      ASSERT_EQ(live.put(t), AppendStatus::accepted);
    }
    live.drain();
    EXPECT_EQ(live.solver.summary().refused, 0U);
    EXPECT_EQ(live.solver.summary().newest_time, t);
    // The motion is too long ago to reach the first waypoint, but the curve reaches later ones.
    const double x = Live::x(t);
    for (int ms = 10; ms <= 1000; ms += 10) {
      ASSERT_EQ(live.append(t + milliseconds(ms), {&x, 1}), AppendStatus::accepted);
      live.clock.time += milliseconds(10);
      live.drain();
    }
    const auto course = static_cast<Course>(live.solver.summary().course);
    EXPECT_TRUE(course == Course::on_target || course == Course::entering);
    EXPECT_NEAR(live.position_at(t + milliseconds(1000)), x, 1e-12);
  }
}

}  // namespace
}  // namespace splinecast::ipc
