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

TEST(LiveSolver, ALateReplacementTakesEffectAsSoonAsPossibleAndPassesOverWhatIsBefore) {
  for (const int late : {20, 32, 40, 400}) {  // ms: before, between and after its waypoints
    Live live;
    live.put_all(50, 500);
    EXPECT_EQ(live.replace(Live::kNow + milliseconds(4), {Live::kNow + milliseconds(30)}),
              AppendStatus::too_late);
    const Time t = Live::kNow + milliseconds(10);
    const Time last = t + milliseconds(30);
    ASSERT_EQ(live.replace(t, {t + milliseconds(20), last}), AppendStatus::accepted);
    live.clock.time += milliseconds(late);
    const Time cut = live.clock.time + milliseconds(5);
    live.solver.step(live.clock);
    const Summary& summary = live.solver.summary();
    EXPECT_EQ(summary.changed_from, cut);
    EXPECT_EQ(summary.refused, 0U);
    EXPECT_EQ(summary.controls, 1U);
    EXPECT_EQ(summary.newest_time, last);
    if (cut > Live::kNow + milliseconds(100)) {
      EXPECT_NEAR(live.position_at(cut), Live::x(cut), 1e-9) << "the cut is on the old curve";
    }
    for (int ms = 510; ms <= 1500; ms += 10) {
      ASSERT_EQ(live.put(Live::kNow + milliseconds(ms)), AppendStatus::accepted);
    }
    live.drain();
    EXPECT_EQ(summary.refused, 0U);
    EXPECT_NEAR(live.position_at(Live::kNow + milliseconds(1400)),
                Live::x(Live::kNow + milliseconds(1400)), 1e-12);
  }
}

TEST(LiveSolver, AReplacementWithoutATimeTakesEffectAsSoonAsPossible) {
  Live live;
  live.put_all(50, 500);
  std::vector<Time> times;
  for (int ms = 1; ms <= 401; ms += 10) times.push_back(Live::kNow + milliseconds(ms));
  ASSERT_EQ(live.replace(Time::min(), times), AppendStatus::accepted);
  live.drain();
  const Summary& summary = live.solver.summary();
  EXPECT_EQ(summary.changed_from, Live::kNow + milliseconds(5));
  EXPECT_EQ(summary.knots, 46U + times.size());
  EXPECT_EQ(summary.refused, 0U);
  EXPECT_GE(summary.passed_over, 1U) << "the one before the cut";
  EXPECT_NEAR(live.position_at(times.back()), Live::x(times.back()), 1e-12);
  EXPECT_EQ(live.replace(Time::min(), {Live::kNow - milliseconds(1), Live::kNow}),
            AppendStatus::too_late);
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

/// The largest distance from a motion of amplitude 1 of which each plan has only this many goals,
/// after two seconds, and the time in which the curve nearly stops although the motion does not.
struct Followed {
  double error = 0;
  Time stopped{};
};
Followed follow_goals(int goals) {
  Live live({.settle = 2}, 1024);
  const auto target = [&](Time t) { return std::sin(3 * to_seconds(t - Live::kNow)); };
  const auto send = [&](Time from) {
    std::vector<double> x;
    std::vector<Waypoint> plan;
    for (int i = 0; i < goals; ++i) x.push_back(target(from + i * milliseconds(33)));
    for (int i = 0; i < goals; ++i) {
      plan.push_back({.time = from + i * milliseconds(33),
                      .position = std::span(x).subspan(static_cast<std::size_t>(i), 1)});
    }
    const WaypointRingWriter::Solved known{.consumed = live.solver.summary().consumed,
                                           .settled_until = live.board.reader.look().settled_until};
    return live.ring.writer.replace_from(Time::min(), plan, known);
  };
  Followed found;
  double before = 0;
  for (int ms = 0; ms < 7000; ++ms, live.clock.time += milliseconds(1)) {
    const Time now = live.clock.time;
    if (ms % 33 == 0) {
      EXPECT_EQ(send(now + milliseconds(100)), AppendStatus::accepted) << ms;
    }
    live.drain();
    const double x = live.position_at(now);
    if (ms > 2000) {
      found.error = std::max(found.error, std::abs(x - target(now)));
      const double speed = std::abs(std::cos(3 * to_seconds(now - Live::kNow)));
      if (speed > 0.5 && std::abs(x - before) < 0.0001) found.stopped += milliseconds(1);
    }
    before = x;
  }
  return found;
}

TEST(LiveSolver, PlansOfOneOrTwoGoalsShowTheMotionThatTheyAreOf) {
  for (const int goals : {1, 2}) {
    const Followed found = follow_goals(goals);
    EXPECT_LT(found.error, 0.15) << goals;
    EXPECT_EQ(found.stopped, Time::zero()) << goals;
  }
}

}  // namespace
}  // namespace splinecast::ipc
