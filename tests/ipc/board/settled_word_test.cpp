#include <gtest/gtest.h>

#include "tests/fixtures/streams/memory_stream.hpp"

namespace splinecast::ipc {
namespace {

using testing::MemoryBoard;

TEST(SettledWord, IsStoredWithoutARevisionAndKeptByTheNextWriter) {
  MemoryBoard board(1, 16);
  Summary summary{.first = 1, .newest = 1};
  board.writer.commit(summary);
  board.writer.store_settled(Time(50));
  EXPECT_EQ(board.reader.look().settled_until, Time(50));
  EXPECT_EQ(board.reader.look().revision, 1U);
  board.writer.store_settled(Time(70));
  EXPECT_EQ(board.reader.look().settled_until, Time(70));
  EXPECT_EQ(board.reader.look().revision, 1U);
  board.replace_writer();
  EXPECT_EQ(board.reader.look().settled_until, Time(70));
}

}  // namespace
}  // namespace splinecast::ipc
