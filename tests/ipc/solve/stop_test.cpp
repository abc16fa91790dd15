#include <gtest/gtest.h>

#include <chrono>
#include <vector>

#include "tests/fixtures/streams/live_stream.hpp"
#include "tests/fixtures/streams/live_world.hpp"

namespace splinecast::ipc {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using Live = testing::LiveStream;
using testing::LiveWorld;

void expect_balance(const Summary& summary) {
  EXPECT_EQ(summary.consumed,
            summary.knots + summary.refused + summary.withdrawn + summary.controls);
}

/// Sends a stop for the earliest possible time and expects that one step makes it effective.
void expect_immediate_stop(Live& live) {
  ASSERT_EQ(live.replace(live.solved().settled_until, {}), AppendStatus::accepted);
  const Word stop = live.ring.writer.written() - 1;
  EXPECT_TRUE(live.solver.step(live.clock).published);
  const Summary& summary = live.solver.summary();
  EXPECT_EQ(summary.consumed, stop + 1);
  EXPECT_EQ(summary.changed_from, live.clock.time + milliseconds(5));
  EXPECT_EQ(summary.newest_time, live.clock.time + milliseconds(5));
  expect_balance(summary);
  const Time rest = summary.newest_time + live.window.stop_length;
  EXPECT_EQ(live.sampler.preview(rest, live.state.ref()), SampleStatus::holding);
}

TEST(Stop, TakesEffectInTheNextStepAfterALateReplacement) {
  Live live;
  live.put_all(50, 2000);
  const Time t = live.solved().settled_until;
  ASSERT_EQ(live.replace(t, {t + milliseconds(500), t + milliseconds(900)}),
            AppendStatus::accepted);
  live.clock.time += milliseconds(10);  // too late for the replacement
  expect_immediate_stop(live);
  EXPECT_EQ(live.solver.summary().refused, 0U);
}

TEST(Stop, TakesEffectInTheNextStepAfterAReplacementInTheFuture) {
  Live live({.settle = 2}, 64);
  live.put_all(50, 2050);  // more than the board has room for
  const Time t = Live::kNow + milliseconds(1900);
  ASSERT_GT(t, live.solver.summary().newest_time);
  ASSERT_EQ(live.replace(t, {t + milliseconds(10)}), AppendStatus::accepted);
  ASSERT_EQ(live.replace(t, {}), AppendStatus::accepted);
  EXPECT_FALSE(live.solver.step(live.clock).published);
  live.clock.time += milliseconds(20);
  live.solver.step(live.clock);
  expect_immediate_stop(live);
}

TEST(Stop, DoesNotWaitForRoomOnTheBoard) {
  Live live({.settle = 2}, 64, {.history = seconds(10)});
  live.put_all(50, 2000);
  const Time newest = live.solver.summary().newest_time;
  live.clock.time = newest - milliseconds(8);
  live.solver.step(live.clock);
  ASSERT_LT(live.solver.summary().consumed, live.ring.writer.written());
  live.clock.time = newest - milliseconds(6);  // in the last segment before the stop segment
  expect_immediate_stop(live);
}

/// A replacement withdraws waypoints only in the revision that publishes it. While this revision
/// waits for room on the board, nothing is withdrawn.
TEST(Stop, OrReplacementThatWaitsForRoomWithdrawsNothing) {
  Live live({.settle = 2}, 64, {.history = seconds(10)});
  live.put_all(50, 630);  // leaves no room for a cut at the newest knot
  const Time newest = live.solver.summary().newest_time;
  ASSERT_EQ(newest, Live::kNow + milliseconds(630));
  ASSERT_EQ(live.put(newest + milliseconds(10)), AppendStatus::accepted);
  ASSERT_EQ(live.put(newest + milliseconds(20)), AppendStatus::accepted);
  ASSERT_EQ(live.replace(newest, {newest + milliseconds(100)}), AppendStatus::accepted);
  live.clock.time += milliseconds(3);
  live.solver.step(live.clock);
  EXPECT_EQ(live.solver.summary().withdrawn, 0U);
  EXPECT_EQ(live.solver.summary().consumed + 4, live.ring.writer.written());
  // A stop for which the board has room withdraws them.
  expect_immediate_stop(live);
  EXPECT_EQ(live.solver.summary().withdrawn, 4U);
}

TEST(Stop, AtTheLatestTimeLeavesAReadableBoardAfterAFinish) {
  Live live;
  live.put_all(50, 100);
  ASSERT_EQ(live.replace(kLatestTime, {}), AppendStatus::accepted);
  live.drain();
  live.finish({.kind = ConditionKind::halt, .value = {}});
  EXPECT_TRUE(live.solver.summary().finished);
  Sampler later(live.board.reader, StreamClock::monotonic);
  EXPECT_EQ(later.sample(Live::kNow + milliseconds(80), live.state.ref()), SampleStatus::settled);
  EXPECT_NO_THROW(live.replace_solver());
}

TEST(Stop, ThatIsCutAtTheLatestTimeLeavesAReadableBoard) {
  Live live;
  live.put_all(50, 100);
  const Time t = kLatestTime - live.window.stop_length / 2;
  ASSERT_EQ(live.replace(t, {}), AppendStatus::accepted);
  live.drain();
  ASSERT_EQ(live.replace(kLatestTime, {}), AppendStatus::accepted);  // in the stop segment
  live.drain();
  Sampler later(live.board.reader, StreamClock::monotonic);
  for (const Time at : {t - Time(1), t, t + Time(1), kLatestTime}) {
    EXPECT_TRUE(has_values(later.sample(at, live.state.ref())));
  }
  EXPECT_NO_THROW(live.replace_solver());
}

TEST(Stop, AtAFutureTimeTakesEffectAtThatTimeAtTheLatest) {
  Live live({.settle = 2}, 64, {.history = seconds(10)});
  live.put_all(50, 2000);
  const Time newest = live.solver.summary().newest_time;
  const Time t = newest + milliseconds(100);
  ASSERT_EQ(live.replace(t, {}), AppendStatus::accepted);
  for (; live.clock.time < t - milliseconds(5); live.clock.time += milliseconds(1)) {
    live.solver.step(live.clock);
    ASSERT_LT(live.solver.summary().consumed, live.ring.writer.written());
  }
  live.solver.step(live.clock);
  EXPECT_EQ(live.solver.summary().consumed, live.ring.writer.written());
  EXPECT_EQ(live.solver.summary().controls, 1U);
  expect_balance(live.solver.summary());
}

TEST(Stop, IsNeverTooLate) {
  Live live;
  live.put_all(50, 500);
  for (const Time t : {Time::min(), Time(0), Live::kNow - seconds(1), Live::kNow}) {
    ASSERT_EQ(live.replace(t, {}), AppendStatus::accepted) << t.count();
    live.clock.time += milliseconds(7);
    live.drain();
  }
  EXPECT_EQ(live.solver.summary().controls, 4U);
  EXPECT_EQ(live.solver.summary().refused, 0U);
  EXPECT_EQ(live.replace(Live::kNow + milliseconds(4), {Live::kNow + milliseconds(400)}),
            AppendStatus::too_late);
  // The stream continues after the stop.
  EXPECT_EQ(live.put(live.clock.time + milliseconds(300)), AppendStatus::accepted);
}

TEST(Stop, AtAnUnknownTimeAllowsAnyLaterWaypointAlsoFromANewProducer) {
  Live live;
  ASSERT_EQ(live.put(Live::kNow + milliseconds(50)), AppendStatus::accepted);
  ASSERT_EQ(live.ring.writer.replace_from(Time::min(), {}, {}), AppendStatus::accepted);
  WaypointRingWriter next(live.ring.bytes.span(), live.ring.layout, {});
  const double x = 0;
  const Waypoint waypoint{.time = Live::kNow + milliseconds(500), .position = std::span(&x, 1)};
  EXPECT_EQ(live.ring.writer.append(waypoint, {}), AppendStatus::accepted);
  EXPECT_EQ(next.append(waypoint, {}), AppendStatus::accepted);
}

TEST(Stop, BeforeAStreamThatStartsInMotionTakesEffectAtItsStart) {
  Live live;
  const Time t = Live::kNow + milliseconds(200);
  const std::vector<double> one{1};
  ASSERT_EQ(live.ring.writer.start_from({t, one, one, one}, live.solved()), AppendStatus::accepted);
  live.put_all(250, 500);
  ASSERT_EQ(live.replace(Live::kNow + milliseconds(20), {}), AppendStatus::accepted);
  live.solver.step(live.clock);
  EXPECT_EQ(live.solver.summary().controls, 2U);
  EXPECT_EQ(live.solver.summary().newest_time, t);
  EXPECT_EQ(live.sampler.preview(t + live.window.stop_length, live.state.ref()),
            SampleStatus::holding);
}

TEST(Stop, FindsRoomInAFullRingAndTakesEffectInTheNextStep) {
  Live live;
  live.put_all(50, 100);
  int ms = 110;
  while (live.put(Live::kNow + milliseconds(ms)) == AppendStatus::accepted) ms += 10;
  EXPECT_EQ(live.put(Live::kNow + milliseconds(ms)), AppendStatus::full);
  live.clock.time += milliseconds(3);
  expect_immediate_stop(live);
}

/// Tests the bound that replace_from documents, with late replacements, replacements in the future,
/// waypoints that wait because the ring is full, and a paused solver.
TEST(Stop, TakesEffectAtTheNextSettledTimeForAnyQueuedItems) {
  for (std::uint64_t seed = 1; seed <= 60 && !HasFailure(); ++seed) {
    LiveWorld world({.seed = seed,
                     .dimensions = 1 + seed % 3,
                     .replacements = 4,
                     .solver_kills = 1,
                     .producer_kills = 1,
                     .pauses = 2});
    for (int stops = 0; stops < 5; ++stops) {
      world.run(milliseconds(300));
      world.stop_after_misses();
    }
    EXPECT_EQ(world.stops, 5U) << "seed " << seed;
    const Summary& summary = world.summary();
    expect_balance(summary);
    EXPECT_EQ(world.report().changed, 0U) << "seed " << seed;
    EXPECT_LT(world.report().position_step, 1e-11) << "seed " << seed;
    EXPECT_LT(world.report().velocity_step, 1e-9) << "seed " << seed;
    const Verification found = world.verify();
    EXPECT_FALSE(found.first) << "seed " << seed << ": " << found.first->what;
  }
}

}  // namespace
}  // namespace splinecast::ipc
