#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <string>
#include <thread>

#include "splinecast/clock.hpp"
#include "splinecast/producer.hpp"
#include "splinecast/solver.hpp"
#include "tests/fixtures/processes/allocations.hpp"
#include "tests/fixtures/processes/process.hpp"

/// What a producer says became of its items.
namespace splinecast {
namespace {

using namespace std::chrono_literals;

/// A live stream whose solver steps when the test says so.
class ProducerOutcomes : public ::testing::Test {
 protected:
  [[nodiscard]] AppendStatus append(Time t, double x = 0) {
    return producer_.append({.time = t, .position = {&x, 1}});
  }
  void solve() {
    ASSERT_TRUE(solver_.attached() || solver_.attach(clock_));
    for (int i = 0; i < 100 && solver_.step(clock_).consumed > 0; ++i) {
    }
  }

  testing::TestStream stream_;
  MonotonicClock clock_;
  Producer producer_{stream_.name(), {.dimensions = 1}};
  Solver solver_{stream_.name(), {}};
};

TEST_F(ProducerOutcomes, AreByTheNumberOfTheLastItem) {
  const Time begin = clock_.now() + 1s;
  EXPECT_EQ(producer_.last_item(), 0U);
  EXPECT_EQ(producer_.outcome(0).kind, OutcomeKind::waiting);
  for (int i = 0; i < 5; ++i) {
    ASSERT_EQ(append(begin + i * 10ms), AppendStatus::accepted);
    EXPECT_EQ(producer_.last_item(), static_cast<std::uint64_t>(i));
  }
  EXPECT_EQ(append(begin), AppendStatus::out_of_order);
  EXPECT_EQ(producer_.last_item(), 4U);
  solve();
  EXPECT_EQ(to_string(producer_.outcome(4)),
            "in force at " + std::to_string((begin + 40ms).count()) + " ns: spline");

  const double x = 0;
  const Waypoint plan[2] = {{.time = begin + 50ms, .position = {&x, 1}},
                            {.time = begin + 70ms, .position = {&x, 1}}};
  ASSERT_EQ(producer_.replace_from(begin + 25ms, plan), AppendStatus::accepted);
  EXPECT_EQ(producer_.last_item(), 5U);  // its waypoints are 6 and 7
  ASSERT_EQ(producer_.replace_from(begin + 60ms, {}), AppendStatus::accepted);
  EXPECT_EQ(producer_.last_item(), 8U);
  ASSERT_EQ(producer_.replace_from(begin + 60ms, {}), AppendStatus::accepted);
  EXPECT_EQ(producer_.last_item(), 8U);  // the same stop
  solve();
  EXPECT_EQ(producer_.outcome(3).kind, OutcomeKind::withdrawn);
  EXPECT_EQ(producer_.outcome(5).way, OutcomeWay::entry);
  EXPECT_EQ(producer_.outcome(8).way, OutcomeWay::stop);
  ASSERT_EQ(producer_.finish(), AppendStatus::accepted);
  EXPECT_EQ(producer_.last_item(), 9U);
}

TEST_F(ProducerOutcomes, AreThereForAReplacementThatBeginsAStream) {
  const double x = 0;
  const Time begin = clock_.now() + 1s;
  const Waypoint plan[1] = {{.time = begin, .position = {&x, 1}}};
  solve();
  ASSERT_EQ(producer_.replace_from(plan), AppendStatus::accepted);
  const std::uint64_t item = producer_.last_item();
  EXPECT_EQ(item + 2, producer_.appended());
  solve();
  EXPECT_TRUE(is_known(producer_.outcome(item)));
  EXPECT_EQ(producer_.outcome(item + 1).time, begin);
}

TEST_F(ProducerOutcomes, AreWaitedForUntilASolverHasDecided) {
  ASSERT_EQ(append(clock_.now() + 10s), AppendStatus::accepted);
  EXPECT_EQ(producer_.wait_outcome(0, 20ms).kind, OutcomeKind::waiting);
  std::thread solving([this] {
    std::this_thread::sleep_for(20ms);
    solve();
  });
  const ItemOutcome found = producer_.wait_outcome(0, 20s);
  solving.join();
  EXPECT_EQ(found.kind, OutcomeKind::in_force);
  EXPECT_FALSE(found.is_final);
}

TEST_F(ProducerOutcomes, AllocateNothing) {
  ASSERT_EQ(append(clock_.now() + 10s), AppendStatus::accepted);
  solve();
  (void)producer_.outcome(0);
  const std::size_t before = testing::allocations();
  EXPECT_EQ(producer_.outcome(0).kind, OutcomeKind::in_force);
  EXPECT_EQ(producer_.outcome(7).kind, OutcomeKind::waiting);
  EXPECT_EQ(testing::allocations(), before);
}

}  // namespace
}  // namespace splinecast
