#include <gtest/gtest.h>

#include <chrono>
#include <string>
#include <vector>

#include "ipc/owned/outcome.hpp"
#include "ipc/owned/stoppers.hpp"
#include "ipc/requests/stoppers.hpp"
#include "ipc/runs/run_edges.hpp"
#include "tests/fixtures/streams/given_stoppers.hpp"
#include "tests/fixtures/streams/live_stream.hpp"

/// A live stream that stoppers hold and release, in simulated time.
namespace splinecast::ipc {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

struct StoppedStream : testing::LiveStream {
  using LiveStream::LiveStream;
  testing::GivenStoppers stoppers;

  void heed() { solver.heed(stoppers); }
  void hold(const std::string& name = "anna") {
    stoppers.set(name, true);
    drain();
  }
  void release(const std::string& name = "anna") {
    stoppers.set(name, false);
    drain();
  }
  /// Steps the solver every 2 ms until this time.
  void run_until(Time t) {
    for (; clock.time < t; clock.time += milliseconds(2)) drain();
  }
  void replace_solver() {
    MemoryStream::replace_solver();
    heed();
  }
  [[nodiscard]] const Summary& summary() const { return solver.summary(); }
  [[nodiscard]] double velocity_at(Time t) {
    EXPECT_TRUE(has_values(sampler.preview(t, state.ref())));
    return state.velocity()[0];
  }
  [[nodiscard]] ItemOutcome outcome(Word item) {
    return outcome_of(board.reader, ring.reader, item);
  }
};

void expect_balance(const Summary& summary) {
  EXPECT_EQ(summary.consumed,
            summary.knots + summary.refused + summary.withdrawn + summary.controls);
}

TEST(AStopper, StopsTheCurveAtTheSettledTime) {
  StoppedStream live;
  live.heed();
  live.put_all(50, 900);
  live.run_until(StoppedStream::kNow + milliseconds(300));
  const Time settled = live.clock.time + milliseconds(5);
  const double before = live.velocity_at(settled);
  ASSERT_GT(before, 0.1);
  live.hold();
  EXPECT_EQ(live.summary().holders, 1U);
  EXPECT_EQ(live.board.reader.holders(), 1U);
  EXPECT_EQ(holders_of(live.board.reader), (std::vector<std::string>{"anna"}));
  EXPECT_EQ(live.summary().newest_time, settled);
  EXPECT_EQ(live.velocity_at(settled), before);
  EXPECT_EQ(live.sampler.preview(settled + live.window.stop_length, live.state.ref()),
            SampleStatus::holding);
  // The waypoints after the cut: those at 310 ms and later.
  EXPECT_EQ(live.summary().cut_off, 60U);
  EXPECT_EQ(live.summary().interpolated(), 26U);
  EXPECT_EQ(live.outcome(25).kind, OutcomeKind::in_force);
  EXPECT_EQ(live.outcome(26).kind, OutcomeKind::withdrawn);
  expect_balance(live.summary());
}

TEST(AStopper, HasItsSlotAndTheItemsInTheKnotAtWhichTheStopBegins) {
  StoppedStream live;
  live.heed();
  live.put_all(50, 500);
  live.stoppers.set("released", false);
  live.run_until(StoppedStream::kNow + milliseconds(200));
  live.hold();
  const Word items = live.summary().consumed;
  KnotCopy knot(1, false);
  ASSERT_TRUE(live.board.reader.copy_knot(live.summary().newest, live.summary().revision, knot));
  ASSERT_TRUE(knot.begins_stoppers_stop());
  EXPECT_FALSE(knot.begins_at_rest());
  EXPECT_EQ(stop_origin(knot.item).items, items);
  EXPECT_EQ(stop_origin(knot.item).slot, 1U);
  EXPECT_EQ(stopper_of(live.board.reader, 1), "anna");
}

TEST(AStopper, LetsTheSolverRefuseWhatWouldMoveTheMachine) {
  StoppedStream live;
  live.heed();
  live.put_all(50, 500);
  live.run_until(StoppedStream::kNow + milliseconds(200));
  const Word first = live.ring.writer.written();
  const Time t = live.clock.time;
  ASSERT_EQ(live.put(t + milliseconds(310)), AppendStatus::accepted);
  ASSERT_EQ(live.replace(t + milliseconds(20), {t + milliseconds(100), t + milliseconds(200)}),
            AppendStatus::accepted);
  live.hold();
  EXPECT_EQ(live.summary().consumed, first + 4);
  EXPECT_EQ(live.reason(Refusal::stopped), 4U);
  EXPECT_EQ(live.summary().withdrawn, 0U);
  for (Word item = first; item < first + 4; ++item) {
    EXPECT_EQ(live.outcome(item).reason, Refusal::stopped) << item;
  }
  const auto refused = live.board.reader.refusal(live.summary().refused - 1);
  EXPECT_EQ(refused.reason, Refusal::stopped);
  EXPECT_EQ(stopper_of(live.board.reader, refused.slot), "anna");
  expect_balance(live.summary());
}

TEST(AStopper, IsKnownToTheProducerWhichAppendsNothing) {
  StoppedStream live;
  live.heed();
  live.put_all(50, 500);
  live.run_until(StoppedStream::kNow + milliseconds(200));
  live.hold();
  auto known = live.solved();
  known.is_stopped = live.board.reader.holders() > 0;
  const Time t = live.clock.time;
  const double x = 0;
  const Waypoint waypoint{.time = t + milliseconds(600), .position = {&x, 1}};
  EXPECT_EQ(live.ring.writer.append(waypoint, known), AppendStatus::stopped);
  EXPECT_EQ(live.ring.writer.replace_from(t + milliseconds(20), {&waypoint, 1}, known),
            AppendStatus::stopped);
  EXPECT_EQ(live.ring.writer.replace_from(t, {}, known), AppendStatus::accepted);  // a stop
  live.drain();
  live.release();
  // Earlier than the waypoints that were sent before: a run begins.
  known = live.solved();
  const Waypoint next{.time = live.clock.time + milliseconds(100), .position = {&x, 1}};
  EXPECT_EQ(live.ring.writer.append(next, known), AppendStatus::accepted);
}

TEST(AStopper, HoldsUntilAllHaveReleased) {
  StoppedStream live;
  live.heed();
  live.put_all(50, 900);
  live.run_until(StoppedStream::kNow + milliseconds(200));
  live.hold("anna");
  live.hold("panel");
  EXPECT_EQ(live.summary().holders, 2U);
  live.run_until(live.clock.time + seconds(1));
  live.release("anna");
  EXPECT_EQ(live.summary().holders, 1U);
  const Time t = live.clock.time;
  ASSERT_EQ(live.put(t + milliseconds(200)), AppendStatus::accepted);
  live.drain();
  EXPECT_EQ(live.reason(Refusal::stopped), 1U);
  live.release("panel");
  EXPECT_EQ(live.summary().holders, 0U);
  EXPECT_EQ(holders_of(live.board.reader), std::vector<std::string>{});
}

TEST(AStopper, LeavesTheCurveWhereARunBeginsWithTheNextWaypoint) {
  StoppedStream live;
  live.heed();
  live.put_all(50, 900);
  live.run_until(StoppedStream::kNow + milliseconds(300));
  live.hold();
  live.run_until(live.clock.time + seconds(1));
  const double rest = live.position_at(live.clock.time);
  live.release();
  const Time begin = live.clock.time + milliseconds(300);
  for (int i = 0; i < 200; ++i) {
    ASSERT_EQ(live.put(begin + i * milliseconds(20)), AppendStatus::accepted);
  }
  live.drain();
  EXPECT_EQ(live.position_at(live.clock.time), rest);
  live.run_until(begin + seconds(3));
  EXPECT_EQ(live.position_at(begin + seconds(3)), live.x(begin + seconds(3)));
  expect_balance(live.summary());
}

/// At the very time of the stop an entry would take the place of its knot.
TEST(AStopper, StaysRecordedIfItReleasesAtOnce) {
  StoppedStream live;
  live.heed();
  live.put_all(50, 900);
  live.run_until(StoppedStream::kNow + milliseconds(300));
  live.hold();
  const Word knot_number = live.summary().newest;
  live.release();
  ASSERT_EQ(live.put(StoppedStream::kNow + milliseconds(910)), AppendStatus::accepted);
  live.drain();
  EXPECT_EQ(live.summary().course, static_cast<Word>(Course::ahead));
  KnotCopy knot(1, false);
  ASSERT_TRUE(live.board.reader.copy_knot(knot_number, live.summary().revision, knot));
  EXPECT_TRUE(knot.begins_stoppers_stop());
}

TEST(AStopper, EndsAStreamThatIsFinishedWhereItsStopRests) {
  StoppedStream live;
  live.heed();
  live.put_all(50, 900);
  live.run_until(StoppedStream::kNow + milliseconds(300));
  live.hold();
  const Time rest = live.summary().newest_time + live.window.stop_length;
  const double position = live.position_at(rest);
  ASSERT_EQ(live.ring.writer.finish({.kind = ConditionKind::halt, .value = {}}, live.solved()),
            AppendStatus::accepted);
  live.drain();
  EXPECT_TRUE(live.summary().finished);
  EXPECT_EQ(live.position_at(rest + seconds(10)), position);
  expect_balance(live.summary());
}

TEST(AStopper, EndsASearchForTheEndOfAStream) {
  StoppedStream live;
  live.heed();
  live.put_all(50, 900);
  live.run_until(StoppedStream::kNow + milliseconds(895));  // the last segment has settled
  ASSERT_EQ(live.ring.writer.finish({.kind = ConditionKind::halt, .value = {}}, live.solved()),
            AppendStatus::accepted);
  live.solver.step(live.clock);
  ASSERT_FALSE(live.summary().finished);  // an entry back to the last waypoint is being searched
  live.hold();
  EXPECT_TRUE(live.summary().finished);
  const Time rest = live.clock.time + live.window.stop_length + milliseconds(10);
  EXPECT_EQ(live.sampler.preview(rest, live.state.ref()), SampleStatus::holding);
  EXPECT_EQ(live.summary().end_lateness, Time::zero());
}

TEST(AStopper, HoldsAStreamThatHasNotBegun) {
  StoppedStream live;
  live.heed();
  live.hold();
  EXPECT_EQ(live.summary().holders, 1U);
  live.put_all(50, 300);
  EXPECT_EQ(live.summary().newest, 0U);
  EXPECT_EQ(live.reason(Refusal::stopped), 26U);
  live.release();
  live.clock.time += seconds(1);
  const Time begin = live.clock.time + milliseconds(100);
  for (int i = 0; i < 10; ++i) {
    ASSERT_EQ(live.put(begin + i * milliseconds(10)), AppendStatus::accepted);
  }
  live.drain();
  EXPECT_GT(live.summary().newest, 0U);
  expect_balance(live.summary());
}

/// The producer has compared only the first waypoint with the place where the machine is.
TEST(AStopper, LeavesAStartWhereAnEarlierStreamHasLeftTheMachine) {
  StoppedStream live;
  const double left = -0.5;
  live.board.writer.write_old_end({&left, 1});
  live.replace_solver();
  live.hold();
  live.put_all(50, 100);
  live.release();
  live.run_until(live.clock.time + seconds(1));
  const Time begin = live.clock.time + milliseconds(300);
  for (int i = 0; i < 200; ++i) {
    ASSERT_EQ(live.put(begin + i * milliseconds(20)), AppendStatus::accepted);
  }
  live.drain();
  EXPECT_EQ(live.position_at(live.clock.time + milliseconds(5)), left);
  live.run_until(begin + seconds(3));
  EXPECT_EQ(live.position_at(begin + seconds(3)), live.x(begin + seconds(3)));
}

TEST(AStopper, IsHeardBySolversThatTakeOver) {
  StoppedStream live;
  live.heed();
  live.put_all(50, 900);
  live.run_until(StoppedStream::kNow + milliseconds(300));
  live.stoppers.set("anna", true);  // not heard by the solver that dies
  live.replace_solver();
  live.drain();
  EXPECT_EQ(live.summary().holders, 1U);
  const Word revision = live.summary().revision;
  const Word newest = live.summary().newest;
  live.replace_solver();
  live.drain();
  EXPECT_EQ(live.summary().revision, revision);  // nothing is left to do
  live.run_until(live.clock.time + milliseconds(100));
  EXPECT_EQ(live.summary().newest, newest);
  live.stoppers.set("anna", false);
  live.replace_solver();
  live.drain();
  EXPECT_EQ(live.summary().holders, 0U);
  EXPECT_EQ(live.board.reader.holders(), 0U);
}

TEST(AStopper, CutsAStopThatIsStillToCome) {
  StoppedStream live;
  live.heed();
  live.put_all(50, 900);
  live.run_until(StoppedStream::kNow + milliseconds(300));
  ASSERT_EQ(live.replace(StoppedStream::kNow + milliseconds(800), {}), AppendStatus::accepted);
  live.drain();
  ASSERT_EQ(live.summary().newest_time, StoppedStream::kNow + milliseconds(800));
  live.hold();
  EXPECT_EQ(live.summary().newest_time, live.clock.time + milliseconds(5));
}

TEST(AStopper, LeavesAStopThatIsExecutedAsItIs) {
  StoppedStream live;
  live.heed();
  live.put_all(50, 900);
  live.run_until(StoppedStream::kNow + milliseconds(300));
  ASSERT_EQ(live.replace(live.solved().settled_until, {}), AppendStatus::accepted);
  live.drain();
  const Word newest = live.summary().newest;
  live.run_until(live.clock.time + milliseconds(20));
  live.hold();
  EXPECT_EQ(live.summary().holders, 1U);
  EXPECT_EQ(live.summary().newest, newest);
}

TEST(AStopper, EndsAnEntryThatWaitsForTheNextStep) {
  StoppedStream live;
  live.heed();
  live.put_all(50, 300);
  live.run_until(StoppedStream::kNow + seconds(2));  // starved, at rest
  const double rest = live.position_at(live.clock.time);
  ASSERT_EQ(live.put(live.clock.time + milliseconds(100)), AppendStatus::accepted);
  live.hold();
  EXPECT_EQ(live.position_at(live.clock.time + seconds(1)), rest);
  EXPECT_EQ(live.reason(Refusal::stopped), 1U);
}

TEST(NoStopper, ChangesNothing) {
  StoppedStream with;
  StoppedStream without;
  with.heed();
  for (StoppedStream* live : {&with, &without}) {
    live->put_all(50, 500);
    live->run_until(StoppedStream::kNow + milliseconds(400));
  }
  EXPECT_EQ(with.summary().revision, without.summary().revision);
}

TEST(AStopper, WithoutARequestTakesNoSlot) {
  StoppedStream live;
  live.stoppers.states.push_back({.name = "idle", .id = 7});
  live.heed();
  live.put_all(50, 200);
  EXPECT_TRUE(stoppers_of(live.board.reader).empty());
}

TEST(MoreStoppersThanABoardNames, AllHoldTheStream) {
  StoppedStream live;
  live.heed();
  live.put_all(50, 900);
  for (std::size_t i = 0; i < kMostStoppers; ++i) {
    live.stoppers.set("early" + std::to_string(i), false);
  }
  live.drain();
  EXPECT_EQ(stoppers_of(live.board.reader).size(), kMostStoppers);
  for (std::size_t i = 0; i < kMostStoppers + 4; ++i) live.hold("late" + std::to_string(i));
  EXPECT_EQ(live.summary().holders, kMostStoppers + 4);
  EXPECT_EQ(holders_of(live.board.reader).size(), kMostStoppers);
  for (std::size_t i = 0; i < kMostStoppers; ++i) live.release("late" + std::to_string(i));
  EXPECT_EQ(live.summary().holders, 4U);
  EXPECT_EQ(holders_of(live.board.reader).size(), 4U);
  const Word revision = live.summary().revision;
  live.drain();
  EXPECT_EQ(live.summary().revision, revision);  // none takes another one's slot again and again
}

TEST(AStopper, WhoseRegionIsGoneHoldsNothing) {
  StoppedStream live;
  live.heed();
  live.put_all(50, 900);
  live.hold();
  live.stoppers.states.clear();
  live.drain();
  EXPECT_EQ(live.summary().holders, 0U);
  EXPECT_TRUE(stoppers_of(live.board.reader).empty());
}

}  // namespace
}  // namespace splinecast::ipc
