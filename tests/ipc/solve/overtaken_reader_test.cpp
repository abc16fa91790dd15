#include <gtest/gtest.h>

#include <chrono>

#include "ipc/layout/board_control.hpp"
#include "ipc/sampling/sampler.hpp"
#include "tests/fixtures/streams/live_stream.hpp"
#include "tests/ipc/solve/running_clock.hpp"

/// Which status a reader gets after a revision has changed the curve at a time that it sampled.
namespace splinecast::ipc {
namespace {

using std::chrono::milliseconds;

using Live = testing::LiveStream;

TEST(LiveSolver, AReaderThatSampledAChangedTimeGetsRevisedOnce) {
  Live live;
  live.put_all(50, 100);
  State& state = live.state;
  live.clock.time = Live::kNow + milliseconds(60);
  live.solver.step(live.clock);
  // After the settled time, as if the commit had been late.
  EXPECT_TRUE(has_values(live.sampler.sample(Live::kNow + milliseconds(98), state.ref())));
  live.put_all(110, 150);
  const Time now = Live::kNow + milliseconds(62);
  EXPECT_EQ(live.sampler.sample(now, state.ref()), SampleStatus::revised);
  EXPECT_EQ(live.sampler.sample(now, state.ref()), SampleStatus::settled);
  // A preview does not count as a sample.
  EXPECT_TRUE(has_values(live.sampler.preview(Live::kNow + milliseconds(148), state.ref())));
  live.put_all(160, 170);
  EXPECT_EQ(live.sampler.sample(now, state.ref()), SampleStatus::settled);
}

TEST(LiveSolver, ALaggingReaderGetsRevisedIfItSampledPastTheSettledTime) {
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

/// A reader that samples again after more revisions than the ring of changes holds.
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
  /// Appends 100 waypoints, which gives more revisions than the ring of changes holds.
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

TEST(LiveSolver, ALaggingReaderDoesNotGetRevisedForARestThatContinued) {
  Gap gap;
  gap.rest(100, 500);
  ASSERT_EQ(gap.sample(500), SampleStatus::holding);
  gap.move_on(600);
  EXPECT_EQ(gap.sample(1400), SampleStatus::settled);
}

TEST(LiveSolver, ALaggingReaderDoesNotGetRevisedForAStartThatIsStillAhead) {
  Gap gap;
  gap.live.put_all(900, 1000);
  ASSERT_EQ(gap.sample(20), SampleStatus::holding);
  gap.move_on(1010);
  EXPECT_EQ(gap.sample(500), SampleStatus::holding);
}

TEST(LiveSolver, ALaggingReaderDoesNotGetRevisedForAStopCutAfterItsSample) {
  Gap gap;
  gap.rest(100, 90);
  const Time settled_until = gap.live.sampler.settled_until();
  ASSERT_EQ(gap.sample(130), SampleStatus::stopping);
  ASSERT_GE(Live::kNow + milliseconds(130), settled_until);
  gap.run_to(135);
  gap.move_on(200);
  EXPECT_EQ(gap.sample(1000), SampleStatus::settled);
}

TEST(LiveSolver, ALaggingReaderGetsRevisedForALateCommitIntoItsRest) {
  Gap gap;
  gap.rest(100, 500);
  ASSERT_EQ(gap.sample(506), SampleStatus::holding);
  // Far in the future, so that the first candidate for the entry succeeds.
  ASSERT_EQ(gap.live.put(Live::kNow + milliseconds(2000)), AppendStatus::accepted);
  // Stopped between reading the clock and the commit, until after the start of the entry.
  gap.live.solver.step(RunningClock(gap.live.clock.time, std::chrono::microseconds(2600)));
  ASSERT_EQ(gap.live.solver.summary().late_commits, 1U);
  gap.run_to(510);
  gap.move_on(2010);
  EXPECT_EQ(gap.sample(1400), SampleStatus::revised);
  EXPECT_EQ(gap.sample(1400), SampleStatus::settled);
}

TEST(LiveSolver, ALaggingReaderGetsRevisedForAStopCutBeforeItsSample) {
  Gap gap;
  gap.rest(100, 90);
  ASSERT_EQ(gap.sample(340), SampleStatus::stopping);
  gap.run_to(135);
  gap.move_on(200);
  EXPECT_EQ(gap.sample(1000), SampleStatus::revised);
}

}  // namespace
}  // namespace splinecast::ipc
