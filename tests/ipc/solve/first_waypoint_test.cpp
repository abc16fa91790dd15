#include <gtest/gtest.h>

#include <chrono>
#include <span>

#include "tests/fixtures/streams/memory_stream.hpp"

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
  const Time first = stream.clock.time + live.freeze_ahead;
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

}  // namespace
}  // namespace splinecast::ipc
