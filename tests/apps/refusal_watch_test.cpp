#include "support/refusal_watch.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "splinecast/core/method.hpp"
#include "splinecast/ipc/producer.hpp"
#include "splinecast/ipc/solver.hpp"
#include "support/exit_codes.hpp"
#include "support/process.hpp"

namespace splinecast::apps {
namespace {

/// A stream whose solver refuses every waypoint: its method needs velocities.
class RefusalWatchTest : public ::testing::Test {
 protected:
  void append(int count) {
    for (int i = 0; i < count; ++i) {
      const double x = 0;
      const core::Waypoint waypoint{.time = time_ += core::Time(1'000'000), .position = {&x, 1}};
      ASSERT_EQ(producer_.append(waypoint), ipc::AppendStatus::accepted);
    }
    solver_.attach();
    while (solver_.step(clock_).consumed > 0) {
    }
  }
  RefusalWatch watch() { return {stream_.name(), producer_.stream_id(), {}}; }
  static std::vector<ipc::Word> look(RefusalWatch& watch) {
    std::vector<ipc::Word> items;
    watch.look([&](const ipc::RefusedItem& refused) {
      EXPECT_EQ(refused.reason, ipc::Refusal::lacks_derivatives);
      items.push_back(refused.item);
    });
    return items;
  }

  testing::TestStream stream_;
  ipc::MonotonicClock clock_;
  core::Time time_{};
  ipc::Solver solver_{stream_.name(), {.method = core::find_method("hermite")}};
  ipc::Producer producer_{stream_.name(),
                          {.dimensions = 1, .clock = ipc::StreamClock::recorded, .capacity = 4096}};
};

TEST_F(RefusalWatchTest, SeesEachRefusalOnce) {
  append(3);
  RefusalWatch late = watch();
  EXPECT_TRUE(look(late).empty());
  append(2);
  EXPECT_EQ(look(late), (std::vector<ipc::Word>{3, 4}));
  EXPECT_TRUE(look(late).empty());
  append(1);
  EXPECT_EQ(look(late), std::vector<ipc::Word>{5});
  EXPECT_EQ(late.missed(), 0U);
  EXPECT_EQ(late.head().consumed, 6U);
}

TEST_F(RefusalWatchTest, CountsWhatTheBoardDoesNotKeep) {
  append(1);
  RefusalWatch slow = watch();
  append(2000);
  const auto items = look(slow);
  ASSERT_EQ(items.size(), ipc::kRefusalsKept);
  EXPECT_EQ(items.front(), 2001 - ipc::kRefusalsKept);
  EXPECT_EQ(items.back(), 2000U);
  EXPECT_EQ(slow.missed(), 2000 - ipc::kRefusalsKept);
}

TEST_F(RefusalWatchTest, ANamesakeOfTheStreamIsRefused) {
  append(1);
  EXPECT_THROW(RefusalWatch(stream_.name(), producer_.stream_id() + 1, {}), Failure);
}

}  // namespace
}  // namespace splinecast::apps
