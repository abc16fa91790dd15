#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <span>

#include "tests/fixtures/streams/given_stoppers.hpp"
#include "tests/fixtures/streams/memory_stream.hpp"
#include "tests/fixtures/streams/watched_stream.hpp"

namespace splinecast::ipc {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

/// One step consumes three waypoints. The first of them is exactly at the settled time of this
/// step.
TEST(FirstWaypoint, MayBeAtTheSettledTimeOfTheStepThatTakesIt) {
  const LiveOptions live;
  testing::MemoryStream stream(
      1, {.start = {.kind = ConditionKind::halt, .value = {}}, .held_before_start = true}, 16, 64,
      {}, {}, live);
  stream.clock.time = seconds(100);
  const Time first = stream.clock.time + live.settle_ahead;
  for (int i = 0; i < 3; ++i) {
    const double x = i;
    ASSERT_EQ(stream.append(first + milliseconds(10) * i, std::span(&x, 1)),
              AppendStatus::accepted);
  }
  const StepResult result = stream.solver.step(stream.clock);
  EXPECT_FALSE(result.damaged);
  EXPECT_TRUE(result.published);
  EXPECT_EQ(stream.solver.summary().knots, 3U);
  EXPECT_EQ(stream.solver.summary().newest_time, first + milliseconds(20));
}

/// A stopper has held the stream from its first waypoint on: the curve begins at rest where an
/// earlier stream has left the machine.
TEST(FirstWaypoint, AfterAHoldThatRefusedTheFirstOneVerifies) {
  entries::Watched live;
  testing::GivenStoppers stoppers;
  const double place = 0.4;
  live.board.writer.write_old_end({&place, 1});
  live.replace_solver();
  live.solver.heed(stoppers);
  stoppers.set("button", true);
  live.send(100, place);
  live.step();
  EXPECT_EQ(live.reason(Refusal::stopped), 1U);
  stoppers.set("button", false);
  live.step();
  for (int i = 0; i < 60; ++i) {
    live.run_to(200 + 10 * i - 100);
    live.send(200 + 10 * i, place + 0.3 * (1 - std::cos(0.05 * i)));
  }
  live.end();
  EXPECT_NEAR(live.position_at(entries::at(50)), place, 1e-12);
  EXPECT_EQ(live.verified(), "");
}

}  // namespace
}  // namespace splinecast::ipc
