#include <gtest/gtest.h>

#include <utility>
#include <vector>

#include "ipc/layout/knot_slots.hpp"
#include "ipc/layout/summary.hpp"
#include "tests/fixtures/streams/memory_stream.hpp"

/// Summaries and refusals on a board.
namespace splinecast::ipc {
namespace {

using testing::MemoryBoard;

TEST(KnotBoard, KeepsTheLastRefusalsWithTheirItems) {
  MemoryBoard board(1, 16);
  for (Word i = 0; i < 1500; ++i) {
    board.writer.write_refusal(i, {.item = 10 * i, .reason = Refusal::not_finite});
  }
  for (Word i = 1500 - kRefusalsKept; i < 1500; ++i) {
    ASSERT_EQ(board.reader.refusal(i).item, 10 * i);
    ASSERT_EQ(board.reader.refusal(i).reason, Refusal::not_finite);
  }
}

TEST(KnotBoard, RejectsASummaryWithValuesOutOfRange) {
  MemoryBoard board(1, 16);
  Summary summary;
  for (const auto& [first, newest] :
       std::vector<std::pair<Word, Word>>{{0, 5}, {6, 5}, {1, 17}, {1, kRetiredTag}}) {
    Summary invalid{.first = first, .newest = newest};
    board.writer.commit(invalid);
    EXPECT_FALSE(board.reader.copy_bounds(board.reader.look(), 0, summary)) << newest;
  }
  for (const Time stop : {Time(-1), kLongestStop + Time(1)}) {
    Summary invalid{.first = 1, .newest = 5, .stop = stop};
    board.writer.commit(invalid);
    EXPECT_FALSE(board.reader.copy_bounds(board.reader.look(), 0, summary)) << stop.count();
  }
}

TEST(KnotBoard, ASummaryIsCompleteAlthoughOnlyChangedWordsAreStored) {
  MemoryBoard board(1, 16);
  for (Word value = 1; value <= 12; ++value) {
    Summary summary{.first = 1, .newest = 2};
    // The members change in turn, so that most commits leave most words unchanged.
    summary.consumed = value;
    summary.deadline_misses = value / 3;
    summary.run_frozen = value % 3;
    summary.finished = value % 4 == 3;
    summary.reasons[value % kRefusalReasons] = value;
    summary.refused = value;
    if (value % 5 == 4) board.replace_writer();
    board.writer.commit(summary);
    Summary seen;
    ASSERT_TRUE(board.reader.copy_summary(board.reader.look(), seen));
    EXPECT_EQ(seen.consumed, summary.consumed);
    EXPECT_EQ(seen.deadline_misses, summary.deadline_misses);
    EXPECT_EQ(seen.run_frozen, summary.run_frozen);
    EXPECT_EQ(seen.finished, summary.finished);
    EXPECT_EQ(seen.refused, summary.refused);
    EXPECT_EQ(seen.reasons, summary.reasons);
    EXPECT_EQ(seen.low_water, Time::max());
  }
}

}  // namespace
}  // namespace splinecast::ipc
