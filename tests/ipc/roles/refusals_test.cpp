#include <gtest/gtest.h>

#include <vector>

#include "ipc/board/refusal_record.hpp"
#include "ipc/layout/knot_slots.hpp"
#include "ipc/layout/summary.hpp"
#include "ipc/roles/inspect.hpp"
#include "splinecast/method.hpp"
#include "splinecast/producer.hpp"
#include "splinecast/solver.hpp"
#include "tests/fixtures/processes/allocations.hpp"
#include "tests/fixtures/processes/process.hpp"
#include "tests/fixtures/streams/memory_stream.hpp"

/// How producers and `inspect` report the items that a solver refuses.
namespace splinecast::ipc {
namespace {

constexpr Time kInterval{1'000'000};

/// A stream whose solver refuses every waypoint, because its method needs velocities.
class ProducerRefusals : public ::testing::Test {
 protected:
  ProducerOptions options() const {
    return {.dimensions = 1, .clock = StreamClock::recorded, .capacity = 4096};
  }
  void append(Producer& producer, int count) {
    for (int i = 0; i < count; ++i) {
      const double x = 0;
      const Waypoint waypoint{.time = time_ += kInterval, .position = {&x, 1}};
      ASSERT_EQ(producer.append(waypoint), AppendStatus::accepted);
    }
  }
  void solve() {
    solver_.attach();
    while (solver_.step(clock_).consumed > 0) {
    }
  }
  static std::vector<Word> items(const Refusals& refusals) {
    std::vector<Word> numbers;
    for (const ItemRefusal& refusal : refusals.items) {
      EXPECT_EQ(refusal.reason, Refusal::lacks_derivatives);
      numbers.push_back(refusal.item);
    }
    return numbers;
  }

  testing::TestStream stream_;
  MonotonicClock clock_;
  Time time_{};
  Solver solver_{stream_.name(), {.method = find_method("hermite")}};
};

TEST_F(ProducerRefusals, AreReportedOnceWithItemTimeAndReason) {
  Producer producer(stream_.name(), options());
  EXPECT_TRUE(producer.refusals().items.empty());
  append(producer, 3);
  ASSERT_EQ(producer.finish({}), AppendStatus::accepted);
  solve();
  const Refusals found = producer.refusals();
  ASSERT_EQ(items(found), (std::vector<Word>{0, 1, 2}));
  EXPECT_EQ(found.items[1].time, 2 * kInterval);
  EXPECT_EQ(to_string(found.items[1]), "item 1 refused: lacks derivatives (time 2000000 ns)");
  EXPECT_EQ(found.missed, 0U);
  EXPECT_EQ(found.consumed, 4U);
  EXPECT_TRUE(producer.refusals().items.empty());
  EXPECT_EQ(producer.refusals().consumed, 4U);
}

TEST_F(ProducerRefusals, CountThoseThatTheBoardNoLongerKeeps) {
  Producer producer(stream_.name(), options());
  append(producer, 2000);
  solve();
  const Refusals found = producer.refusals();
  ASSERT_EQ(found.items.size(), kRefusalsKept);
  EXPECT_EQ(found.items.front().item, 2000 - kRefusalsKept);
  EXPECT_EQ(found.items.back().item, 1999U);
  EXPECT_EQ(found.missed, 2000 - kRefusalsKept);
}

TEST_F(ProducerRefusals, HaveNoTimeOnceTheRingHasOverwrittenTheItem) {
  Producer producer(stream_.name(),
                    {.dimensions = 1, .clock = StreamClock::recorded, .capacity = 4});
  append(producer, 3);
  solve();
  append(producer, 2);
  const Refusals found = producer.refusals();
  ASSERT_EQ(found.items.size(), 3U);
  EXPECT_FALSE(found.items[0].time.has_value());
  EXPECT_EQ(found.items[2].time, 3 * kInterval);
}

TEST_F(ProducerRefusals, OfADeadProducerAreNotReportedToItsSuccessor) {
  {
    Producer dies(stream_.name(), options());
    append(dies, 2);
    solve();
    append(dies, 2);
  }
  Producer producer(stream_.name(), options());
  ASSERT_TRUE(producer.continues());
  append(producer, 1);
  solve();
  EXPECT_EQ(items(producer.refusals()), std::vector<Word>{4});
}

TEST_F(ProducerRefusals, AllocateNothingWhenTheResultIsReused) {
  Producer producer(stream_.name(), options());
  Refusals found;
  append(producer, 10);
  solve();
  producer.refusals(found);
  append(producer, 10);
  solve();
  const std::size_t before = testing::allocations();
  producer.refusals(found);
  EXPECT_EQ(testing::allocations(), before);
  EXPECT_EQ(items(found).size(), 10U);
}

TEST_F(ProducerRefusals, AreReportedByTheSolverOncePerReason) {
  Producer producer(stream_.name(), options());
  std::vector<ItemRefusal> reported;
  append(producer, 5);
  solve();
  solver_.take_first_refusals(reported);
  ASSERT_EQ(reported.size(), 1U);
  EXPECT_EQ(reported[0].item, 0U);
  append(producer, 5);
  ASSERT_EQ(producer.finish({}), AppendStatus::accepted);
  solve();
  solver_.take_first_refusals(reported);
  EXPECT_TRUE(reported.empty());
}

TEST_F(ProducerRefusals, AreAllReturnedByInspectIfTheBoardKeepsThem) {
  Producer producer(stream_.name(), options());
  append(producer, 1500);
  solve();
  const StreamInfo info = inspect(stream_.name());
  ASSERT_EQ(info.refusals.size(), kRefusalsKept);
  EXPECT_EQ(info.refusals.front().item, 1500 - kRefusalsKept);
  EXPECT_EQ(info.refusals.back().item, 1499U);
}

TEST(RefusalsOfABoard, ExcludeThoseThatLaterOnesMayOverwrite) {
  testing::MemoryBoard board(1, 32);
  Summary summary{.first = 1};
  for (; summary.refused < kRefusalsKept + 3; ++summary.refused) {
    board.writer.write_refusal(summary.refused,
                               {.item = 2 * summary.refused, .reason = Refusal::past});
  }
  summary.consumed = 2 * summary.refused;
  board.writer.commit(summary);
  std::vector<RefusalRecord> copied(kRefusalsKept);
  EXPECT_EQ(board.reader.copy_refusals(summary, 0, copied), kRefusalsKept);
  EXPECT_EQ(copied.front().item, 6U);
  // Two more refusals, not committed: their items are after those that the summary has consumed.
  for (Word i = 0; i < 2; ++i) {
    board.writer.write_refusal(summary.refused + i,
                               {.item = summary.consumed + i, .reason = Refusal::past});
  }
  EXPECT_EQ(board.reader.copy_refusals(summary, 0, copied), kRefusalsKept - 2);
  EXPECT_EQ(copied.front().item, 10U);
  // They are discarded; a later revision takes the items and refuses none.
  summary.consumed += 10;
  board.writer.commit(summary);
  EXPECT_EQ(board.reader.copy_refusals(summary, 0, copied), kRefusalsKept - 2);
  EXPECT_EQ(board.reader.copy_refusals(summary, summary.refused - 1, copied), 1U);
  EXPECT_EQ(copied.front().item, 2 * summary.refused - 2);
}

}  // namespace
}  // namespace splinecast::ipc
