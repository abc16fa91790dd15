#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <vector>

#include "ipc/sampling/sampler.hpp"
#include "tests/fixtures/streams/live_stream.hpp"

namespace splinecast::ipc {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

using Live = testing::LiveStream;

TEST(LiveSolver, SettlesByTimeAndSaysSoWithoutWaypointsOrRevisionsUntilTheMotionEnds) {
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
  EXPECT_EQ(live.solver.head().settled_until, settled());
  EXPECT_EQ(live.solver.due(), live.clock.time + Time(2'500'000));
  EXPECT_EQ(live.board.reader.revision(), revision);
  live.clock.time = Live::kNow + milliseconds(445);     // the stop ends at 450
  EXPECT_TRUE(live.solver.step(live.clock).published);  // it has starved
  EXPECT_EQ(settled(), Live::kNow + milliseconds(450));
  EXPECT_EQ(live.solver.due(), Time::max());
  EXPECT_EQ(live.sampler.sample(Live::kNow + milliseconds(460), live.state.ref()),
            SampleStatus::holding);
}

TEST(LiveSolver, ItsNextStepTakesUpWhatHasBeenRaisedWithoutOne) {
  Live live;
  live.put_all(50, 200);
  const auto settled = [&] { return live.board.reader.look().settled_until; };
  SettledRaise raise = live.solver.settled_raise();
  EXPECT_TRUE(raise.raise(Live::kNow + milliseconds(20)));
  EXPECT_EQ(settled(), Live::kNow + milliseconds(25));
  EXPECT_TRUE(raise.raise(Live::kNow + milliseconds(10)));  // never back
  EXPECT_EQ(settled(), Live::kNow + milliseconds(25));
  live.clock.time += milliseconds(15);
  const Time early = settled() - Time(1);
  ASSERT_EQ(live.replace(settled(), {settled() + milliseconds(20)}), AppendStatus::accepted);
  live.drain();
  EXPECT_EQ(live.solver.head().controls, 1U);
  EXPECT_GT(live.solver.head().changed_from, early);
  EXPECT_EQ(settled(), Live::kNow + milliseconds(25));
}

TEST(LiveSolver, NothingIsRaisedWhereAStepHasMoreToDo) {
  Live live;
  EXPECT_FALSE(live.solver.settled_raise().raise(Live::kNow));  // there is no curve
  live.put_all(50, 200);
  const Time newest = live.solver.head().newest_knot;
  SettledRaise raise = live.solver.settled_raise();
  EXPECT_TRUE(raise.raise(newest - milliseconds(5) - Time(1)));
  EXPECT_FALSE(raise.raise(newest - milliseconds(5)));  // there it starves
  live.clock.time = newest - milliseconds(5);
  EXPECT_TRUE(live.solver.step(live.clock).published);
  EXPECT_TRUE(live.solver.head().starved);
  EXPECT_FALSE(live.solver.settled_raise().raise(live.clock.time + milliseconds(1)));
}

TEST(LiveSolver, ASolverThatTakesOverGoesOnFromTheSettledTimeThatWasToldLast) {
  Live live;
  live.put_all(50, 200);
  live.clock.time += milliseconds(20);
  EXPECT_FALSE(live.solver.step(live.clock).published);
  const Time settled = Live::kNow + milliseconds(25);
  EXPECT_EQ(live.board.reader.look().settled_until, settled);
  live.replace_solver();
  EXPECT_EQ(live.solver.head().settled_until, settled);
  // Whatever its clock says.
  live.clock.time = Live::kNow;
  live.drain();
  EXPECT_EQ(live.board.reader.look().settled_until, settled);
  EXPECT_EQ(live.replace(settled - Time(1), {settled + milliseconds(20)}), AppendStatus::too_late);
  ASSERT_EQ(live.replace(settled, {settled + milliseconds(20)}), AppendStatus::accepted);
  live.drain();
  EXPECT_EQ(live.solver.head().controls, 1U);
  EXPECT_EQ(live.solver.head().changed_from, settled);
}

TEST(LiveSolver, RefusesAWaypointOnlyIfItIsLaterThanTheStraightLineLasts) {
  Live live;
  live.put_all(50, 200);
  live.clock.time = Live::kNow + milliseconds(600);
  live.solver.step(live.clock);
  const Time settled = live.board.reader.look().settled_until;
  EXPECT_EQ(live.put(settled - kMostLate - Time(1)), AppendStatus::past);
  EXPECT_EQ(live.put(settled - kMostLate), AppendStatus::accepted);
  live.drain();
  EXPECT_EQ(live.solver.head().refused, 0U);
  EXPECT_EQ(live.solver.head().passed_over, 1U);
}

TEST(LiveSolver, RefusesNothingForBeingNearAndEntersAgainAfterAStarvation) {
  Live live;
  live.put_all(50, 200);
  live.clock.time = Live::kNow + milliseconds(300);
  live.solver.step(live.clock);
  EXPECT_EQ(live.solver.head().underruns, 1U);
  EXPECT_TRUE(live.solver.head().starved);
  EXPECT_EQ(live.solver.head().low_water, Time::zero());
  const double settled = live.position_at(Live::kNow + milliseconds(305));
  ASSERT_EQ(live.put(Live::kNow + milliseconds(250)), AppendStatus::accepted);  // late
  ASSERT_EQ(live.put(Live::kNow + milliseconds(307)), AppendStatus::accepted);  // too near to meet
  for (int ms = 350; ms <= 900; ms += 10) {
    ASSERT_EQ(live.put(Live::kNow + milliseconds(ms)), AppendStatus::accepted);
  }
  live.drain();
  const Head& head = live.solver.head();
  EXPECT_EQ(head.refused, 0U);
  EXPECT_FALSE(head.starved);
  EXPECT_EQ(static_cast<Course>(head.course), Course::entering);
  EXPECT_GE(head.passed_over, 1U);
  EXPECT_EQ(head.interpolated() + head.passed_over, head.knots);
  EXPECT_EQ(head.changed_from, Live::kNow + milliseconds(305));
  EXPECT_NEAR(live.position_at(Live::kNow + milliseconds(305)), settled, 1e-12);
  for (int ms = 850; ms <= 900; ms += 10) {
    const Time t = Live::kNow + milliseconds(ms);
    EXPECT_NEAR(live.position_at(t), Live::x(t), 1e-12);
  }
  EXPECT_EQ(head.underruns, 1U);
}

TEST(LiveSolver, ReplacesTheFutureInOneRevisionAndLeavesWhatIsBeforeIt) {
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
  EXPECT_EQ(live.solver.head().changed_from, t);
  EXPECT_EQ(live.solver.head().newest_knot, times.back());
  EXPECT_EQ(live.position_at(t - milliseconds(1)), before);
  live.drain();
  const Head& head = live.solver.head();
  EXPECT_EQ(static_cast<Course>(head.course), Course::entering);
  for (std::size_t i = head.passed_over; i < times.size(); ++i) {
    EXPECT_NEAR(live.position_at(times[i]), Live::x(times[i]), 1e-12) << i;
  }
  EXPECT_LT(head.passed_over, times.size());
  EXPECT_EQ(live.sampler.preview(times.back() + milliseconds(7), live.state.ref()),
            SampleStatus::stopping);
}

TEST(LiveSolver, AReplacementByNothingIsAStopTailFromThere) {
  Live live;
  live.put_all(50, 500);
  const Time t = Live::kNow + milliseconds(250);
  ASSERT_EQ(live.replace(t, {}), AppendStatus::accepted);
  live.drain();
  EXPECT_EQ(live.sampler.preview(t, live.state.ref()), SampleStatus::stopping);
  EXPECT_NEAR(live.state.velocity()[0], Live::velocity(t), 1e-3);
  EXPECT_EQ(live.sampler.preview(t + milliseconds(251), live.state.ref()), SampleStatus::holding);
}

TEST(LiveSolver, AReplacementThatComesTooLateIsRefusedWithAllThatBelongsToIt) {
  Live live;
  live.put_all(50, 500);
  EXPECT_EQ(live.replace(Live::kNow + milliseconds(4), {Live::kNow + milliseconds(30)}),
            AppendStatus::too_late);
  const Time t = Live::kNow + milliseconds(10);
  ASSERT_EQ(live.replace(t, {t + milliseconds(20), t + milliseconds(30)}), AppendStatus::accepted);
  ASSERT_EQ(live.put(Live::kNow + milliseconds(510)), AppendStatus::accepted);
  live.clock.time += milliseconds(20);  // the solver wakes when it is too late
  live.drain();
  EXPECT_EQ(live.reason(Refusal::too_late), 3U);
  EXPECT_EQ(live.solver.head().newest_knot, Live::kNow + milliseconds(510));
  EXPECT_NEAR(live.position_at(Live::kNow + milliseconds(400)),
              Live::x(Live::kNow + milliseconds(400)), 1e-12);
}

TEST(LiveSolver, KeepsItsHistoryAndWithdrawsWhatHasNotBeenTaken) {
  Live live({.settle = 2}, 64, {.history = seconds(1)});
  live.put_all(50, 2050);
  const Head& head = live.solver.head();
  EXPECT_LT(head.newest, 65U);
  EXPECT_LT(head.consumed, live.ring.writer.head());
  EXPECT_EQ(head.first, 1U);
  EXPECT_FALSE(live.solver.step(live.clock).published);  // full: nothing may be overwritten
  const Time t = Live::kNow + milliseconds(300);
  ASSERT_EQ(live.replace(t, {}), AppendStatus::accepted);
  live.drain();
  EXPECT_EQ(head.consumed, live.ring.writer.head());
  EXPECT_GT(head.withdrawn, 100U);
  EXPECT_EQ(head.consumed, head.knots + head.refused + head.withdrawn + head.controls);
  EXPECT_EQ(live.sampler.preview(t + milliseconds(300), live.state.ref()), SampleStatus::holding);
}

TEST(LiveSolver, AFinishBehindASettledKnotGoesBackToIt) {
  for (const int late : {0, 100, 500}) {  // frozen, in the stop, and at rest
    Live live;
    live.put_all(50, 600);
    const Time newest = Live::kNow + milliseconds(600);
    live.clock.time = newest - milliseconds(4) + milliseconds(late);
    live.solver.step(live.clock);
    live.finish({.kind = ConditionKind::halt, .value = {}});
    for (int i = 0; i < 20 && !live.solver.head().finished; ++i) live.solver.step(live.clock);
    EXPECT_TRUE(live.solver.head().finished);
    EXPECT_GT(live.solver.head().changed_from, live.clock.time);
    const Time end = live.solver.head().settled_until;
    EXPECT_GT(end, newest);  // at its time or later
    EXPECT_NEAR(live.position_at(end), Live::x(newest), 1e-12) << late;
    EXPECT_NEAR(live.position_at(end + seconds(5)), Live::x(newest), 1e-12) << late;
    EXPECT_EQ(live.sampler.preview(end + seconds(5), live.state.ref()), SampleStatus::holding);
    // On the way there it has passed it.
    const Time between = newest + (end - newest) / 2;
    EXPECT_GT(live.position_at(between), Live::x(newest));
  }
}

TEST(LiveSolver, StartsFromAGivenStateAndGivesNothingBeforeIt) {
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

/// A clock that goes on by itself behind every look.
class RunningClock final : public Clock {
 public:
  RunningClock(Time now, Time step) : now_(now), step_(step) {}
  [[nodiscard]] Time now() const noexcept override {
    now_ += step_;
    return now_ - step_;
  }

 private:
  mutable Time now_;
  Time step_;
};

TEST(LiveSolver, DiscardsARevisionThatComesTooLateAndMakesItAnew) {
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
  EXPECT_EQ(live.solver.head().misses, 1U);
  EXPECT_NEAR(live.position_at(Live::kNow + milliseconds(110)),
              Live::x(Live::kNow + milliseconds(110)), 1e-12);
}

TEST(LiveSolver, AReaderThatSampledWhatWasChangedIsToldOnce) {
  Live live;
  live.put_all(50, 100);
  State& state = live.state;
  live.clock.time = Live::kNow + milliseconds(60);
  live.solver.step(live.clock);
  // Ahead of what is settled, as if the commit had come late.
  EXPECT_TRUE(has_values(live.sampler.sample(Live::kNow + milliseconds(98), state.ref())));
  live.put_all(110, 150);
  const Time now = Live::kNow + milliseconds(62);
  EXPECT_EQ(live.sampler.sample(now, state.ref()), SampleStatus::revised);
  EXPECT_EQ(live.sampler.sample(now, state.ref()), SampleStatus::settled);
  // A look ahead is none of it.
  EXPECT_TRUE(has_values(live.sampler.preview(Live::kNow + milliseconds(148), state.ref())));
  live.put_all(160, 170);
  EXPECT_EQ(live.sampler.sample(now, state.ref()), SampleStatus::settled);
}

TEST(LiveSolver, AReaderFarBehindIsToldIfItSampledPastWhatWasSettled) {
  for (const bool past : {false, true}) {
    Live live;
    live.put_all(50, 100);
    live.clock.time = Live::kNow + milliseconds(60);
    live.solver.step(live.clock);
    const Time settled = Live::kNow + milliseconds(64);
    const Time t = past ? Live::kNow + milliseconds(80) : settled;
    EXPECT_TRUE(has_values(live.sampler.sample(t, live.state.ref())));
    for (int i = 0; i < 100; ++i) live.put_all(110 + 10 * i, 110 + 10 * i);
    EXPECT_EQ(live.sampler.sample(settled, live.state.ref()),
              past ? SampleStatus::revised : SampleStatus::settled);
  }
}

/// As a producer does that replaces the future with each chunk, the first one too.
TEST(LiveSolver, AReplacementOnAStreamWithoutWaypointsStartsIt) {
  for (const bool stops_first : {false, true}) {
    Live live;
    if (stops_first) {
      ASSERT_EQ(live.replace(Live::kNow, {}), AppendStatus::accepted);
      live.drain();
      EXPECT_EQ(live.solver.head().newest, 0U);
    }
    Live appended;
    std::vector<Time> times;
    for (int ms = 50; ms <= 200; ms += 10) times.push_back(Live::kNow + milliseconds(ms));
    ASSERT_EQ(live.replace(Live::kNow + milliseconds(40), times), AppendStatus::accepted);
    live.drain();
    appended.put_all(50, 200);
    const Head& head = live.solver.head();
    EXPECT_EQ(head.refused, 0U);
    EXPECT_EQ(head.controls, stops_first ? 2U : 1U);
    EXPECT_EQ(head.knots, times.size());
    EXPECT_EQ(head.consumed, head.knots + head.controls);
    for (int ms = 0; ms < 400; ++ms) {
      const Time t = Live::kNow + milliseconds(ms);
      EXPECT_EQ(live.position_at(t), appended.position_at(t)) << ms;
    }
  }
}

TEST(LiveSolver, AStreamThatHasRestedLongerThanTheMostIntervalGoesOn) {
  for (const bool replaces : {false, true}) {
    Live live;
    live.put_all(50, 200);
    live.clock.time = Live::kNow + std::chrono::seconds(1);
    EXPECT_TRUE(live.solver.step(live.clock).published);  // the last time: it rests
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
    EXPECT_EQ(live.solver.head().refused, 0U);
    EXPECT_EQ(live.solver.head().newest_knot, t);
    // What it has shown is too long ago for the first waypoint to be met: the next ones are.
    const double x = Live::x(t);
    for (int ms = 10; ms <= 1000; ms += 10) {
      ASSERT_EQ(live.append(t + milliseconds(ms), {&x, 1}), AppendStatus::accepted);
      live.clock.time += milliseconds(10);
      live.drain();
    }
    const auto course = static_cast<Course>(live.solver.head().course);
    EXPECT_TRUE(course == Course::on_target || course == Course::entering);
    EXPECT_NEAR(live.position_at(t + milliseconds(1000)), x, 1e-12);
  }
}

/// What a reader is told that samples once, and again when more revisions have passed than the
/// board keeps the changes of.
struct Gap {
  Live live;

  void rest(int newest_ms, int now_ms) {
    live.put_all(newest_ms - 50, newest_ms);
    run_to(now_ms);
  }
  void run_to(int ms) {
    while (live.clock.time < Live::kNow + milliseconds(ms)) {
      live.clock.time += milliseconds(1);
      live.solver.step(live.clock);
    }
  }
  SampleStatus sample(int ms) {
    return live.sampler.sample(Live::kNow + milliseconds(ms), live.state.ref());
  }
  /// Goes on for 100 revisions and more.
  void move_on(int from_ms) {
    const Word revision = live.board.reader.revision();
    for (int ms = from_ms; ms < from_ms + 1000; ms += 10) {
      ASSERT_EQ(live.put(Live::kNow + milliseconds(ms)), AppendStatus::accepted) << ms;
      live.solver.step(live.clock);
      live.clock.time += milliseconds(10);
    }
    ASSERT_GT(live.board.reader.revision(), revision + kChangesKept);
  }
};

TEST(LiveSolver, AReaderFarBehindIsNotToldOfARestThatWentOn) {
  Gap gap;
  gap.rest(100, 500);
  ASSERT_EQ(gap.sample(500), SampleStatus::holding);
  gap.move_on(600);
  EXPECT_EQ(gap.sample(1400), SampleStatus::settled);
}

TEST(LiveSolver, AReaderFarBehindIsNotToldOfAStartThatIsStillAhead) {
  Gap gap;
  gap.live.put_all(900, 1000);
  ASSERT_EQ(gap.sample(20), SampleStatus::holding);
  gap.move_on(1010);
  EXPECT_EQ(gap.sample(500), SampleStatus::holding);
}

TEST(LiveSolver, AReaderFarBehindIsNotToldOfAStopThatWasCutBehindItsSample) {
  Gap gap;
  gap.rest(100, 90);
  const Time settled_until = gap.live.sampler.settled_until();
  ASSERT_EQ(gap.sample(130), SampleStatus::stopping);
  ASSERT_GE(Live::kNow + milliseconds(130), settled_until);
  gap.run_to(135);
  gap.move_on(200);
  EXPECT_EQ(gap.sample(1000), SampleStatus::settled);
}

TEST(LiveSolver, AReaderFarBehindIsToldOfALateCommitIntoItsRest) {
  Gap gap;
  gap.rest(100, 500);
  ASSERT_EQ(gap.sample(506), SampleStatus::holding);
  // So far ahead that the first entry that is tried passes.
  ASSERT_EQ(gap.live.put(Live::kNow + milliseconds(2000)), AppendStatus::accepted);
  // Stopped between the look at the clock and the commit, until after the start of the entry.
  gap.live.solver.step(RunningClock(gap.live.clock.time, std::chrono::microseconds(2600)));
  ASSERT_EQ(gap.live.solver.head().revisions, 1U);
  gap.run_to(510);
  gap.move_on(2010);
  EXPECT_EQ(gap.sample(1400), SampleStatus::revised);
  EXPECT_EQ(gap.sample(1400), SampleStatus::settled);
}

TEST(LiveSolver, AReaderFarBehindIsToldThatItsStopWasCutBeforeItsSample) {
  Gap gap;
  gap.rest(100, 90);
  ASSERT_EQ(gap.sample(340), SampleStatus::stopping);
  gap.run_to(135);
  gap.move_on(200);
  EXPECT_EQ(gap.sample(1000), SampleStatus::revised);
}

}  // namespace
}  // namespace splinecast::ipc
