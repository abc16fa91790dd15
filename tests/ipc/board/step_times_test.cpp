#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "ipc/layout/board_control.hpp"
#include "tests/fixtures/streams/memory_stream.hpp"

namespace splinecast::ipc {
namespace {

using testing::MemoryBoard;

TEST(StepTimes, AreCountedInPowerOfTwoBuckets) {
  MemoryBoard board(1, 16);
  const std::vector<std::pair<std::int64_t, std::size_t>> steps{
      {-5, 0},
      {0, 0},
      {1, 0},
      {2, 1},
      {3, 1},
      {4, 2},
      {1023, 9},
      {1024, 10},
      {std::int64_t{1} << 38, 38},
      {(std::int64_t{1} << 40) - 1, 39},
      {std::int64_t{1} << 40, 39},
      {std::numeric_limits<std::int64_t>::max(), 39}};
  std::array<Word, kStepBuckets> wanted{};
  for (const auto& [length, bucket] : steps) {
    board.writer.count_step(Time(length));
    ++wanted[bucket];
    EXPECT_EQ(board.reader.step_times(), wanted) << length;
  }
  board.replace_writer();
  EXPECT_EQ(board.reader.step_times(), wanted);
}

}  // namespace
}  // namespace splinecast::ipc
