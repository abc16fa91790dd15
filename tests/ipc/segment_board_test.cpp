#include "splinecast/ipc/segment_board.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>
#include <vector>

#include "support/memory_stream.hpp"

namespace splinecast::ipc {
namespace {

using core::Time;
using testing::MemoryBoard;

constexpr std::size_t kDimensions = 3;

/// A segment all of whose values say which number and which revision it is of.
core::Segment marked(Word number, Word revision) {
  core::Segment segment(kDimensions);
  segment.left = Time(static_cast<std::int64_t>(number) * 100);
  segment.right = segment.left + Time(100);
  segment.order = number % 2 == 0 ? 4 : 6;
  for (double& c : segment.coefficients) c = static_cast<double>(number * 1000 + revision);
  return segment;
}

void write(MemoryBoard& board, Word number, Word revision) {
  const std::vector<double> zeros(kDimensions);
  const core::Knot knot{.time = {},
                        .prefix = {},
                        .newer_knots = 0,
                        .waypoint = zeros,
                        .g = zeros,
                        .position = zeros,
                        .velocity = zeros,
                        .acceleration = {},
                        .residual = {}};
  board.writer.write(number, marked(number, revision), knot);
}

/// Commits `segments` segments as the next revision.
void publish(MemoryBoard& board, Word first, Word newest) {
  Head head{.first = first, .newest = newest};
  board.writer.commit(head);
}

/// The revision that a copy of segment `number` is marked with; 0 if it cannot be had. Fails the
/// test if the copy is not whole.
Word revision_of(const SegmentBoardReader& board, Word number, Word r, SegmentCopy& copy) {
  if (!board.copy_segment(number, r, copy)) return 0;
  const auto values = static_cast<std::size_t>(copy.order) * kDimensions;
  for (std::size_t i = 1; i < values; ++i) {
    if (copy.coefficients[i] != copy.coefficients[0]) return kRetiredTag;
  }
  if (copy.left != Time(static_cast<std::int64_t>(number) * 100)) return kRetiredTag;
  return static_cast<Word>(copy.coefficients[0]) - number * 1000;
}

TEST(SegmentBoard, ARevisionAppearsAtOnceAndTheOneBeforeStaysReadable) {
  MemoryBoard board(kDimensions, 16);
  SegmentCopy copy(kDimensions);
  Head head;
  EXPECT_EQ(board.reader.revision(), 0U);
  EXPECT_FALSE(board.reader.copy_head(0, head));
  for (Word n = 1; n <= 5; ++n) write(board, n, 1);
  EXPECT_EQ(board.reader.revision(), 0U);
  publish(board, 1, 5);
  ASSERT_EQ(board.reader.revision(), 1U);
  for (Word n = 3; n <= 6; ++n) write(board, n, 2);
  for (Word n = 1; n <= 5; ++n) EXPECT_EQ(revision_of(board.reader, n, 1, copy), 1U) << n;
  publish(board, 1, 6);
  for (Word n = 1; n <= 6; ++n) {
    EXPECT_EQ(revision_of(board.reader, n, 2, copy), n < 3 ? 1U : 2U) << n;
    EXPECT_EQ(revision_of(board.reader, n, 1, copy), n < 6 ? 1U : 0U) << n;
  }
  ASSERT_TRUE(board.reader.copy_head(1, head));
  EXPECT_EQ(head.newest, 5U);
  ASSERT_TRUE(board.reader.copy_head(2, head));
  EXPECT_EQ(head.newest, 6U);
}

TEST(SegmentBoard, ACopyIsCurrentUntilItsSegmentIsWrittenAgain) {
  MemoryBoard board(kDimensions, 16);
  SegmentCopy copy(kDimensions);
  write(board, 1, 1);
  write(board, 2, 1);
  publish(board, 1, 2);
  ASSERT_EQ(revision_of(board.reader, 1, 1, copy), 1U);
  write(board, 2, 2);
  publish(board, 1, 2);
  EXPECT_TRUE(board.reader.is_current(copy, 2));
  write(board, 1, 3);
  EXPECT_TRUE(board.reader.is_current(copy, 2));
  publish(board, 1, 2);
  EXPECT_FALSE(board.reader.is_current(copy, 3));
}

TEST(SegmentBoard, ANewWriterRetiresWhatTheDeadOneDidNotCommit) {
  MemoryBoard board(kDimensions, 16);
  SegmentCopy copy(kDimensions);
  for (Word n = 1; n <= 3; ++n) write(board, n, 1);
  publish(board, 1, 3);
  write(board, 2, 2);
  write(board, 3, 2);  // and dies
  board.replace_writer();
  for (Word r = 1; r <= 4; ++r) {
    for (Word n = 1; n <= 3; ++n) EXPECT_EQ(revision_of(board.reader, n, r, copy), 1U);
  }
  write(board, 3, 2);
  publish(board, 1, 3);
  EXPECT_EQ(revision_of(board.reader, 2, 2, copy), 1U);
  EXPECT_EQ(revision_of(board.reader, 3, 2, copy), 2U);
}

TEST(SegmentBoard, ASlotIsReusedOnlyUnderTheNewNumber) {
  MemoryBoard board(kDimensions, 4);
  SegmentCopy copy(kDimensions);
  for (Word n = 1; n <= 40; ++n) {
    write(board, n, n);
    publish(board, n > 4 ? n - 3 : 1, n);
    for (Word back = 0; back < 4 && back < n; ++back) {
      EXPECT_EQ(revision_of(board.reader, n - back, n, copy), n - back);
    }
    if (n > 4) {
      EXPECT_EQ(revision_of(board.reader, n - 4, n, copy), 0U);
    }
  }
}

TEST(SegmentBoard, KeepsTheLastRefusalsWithTheirItems) {
  MemoryBoard board(1, 16);
  for (Word i = 0; i < 1500; ++i) {
    board.writer.write_refusal(i, {.item = 10 * i, .reason = Refusal::not_finite});
  }
  for (Word i = 1500 - kRefusalsKept; i < 1500; ++i) {
    ASSERT_EQ(board.reader.refusal(i).item, 10 * i);
    ASSERT_EQ(board.reader.refusal(i).reason, Refusal::not_finite);
  }
}

TEST(SegmentBoard, AHeadThatCannotBeIsNotBelieved) {
  MemoryBoard board(1, 16);
  Head head;
  for (const auto& [first, newest] :
       std::vector<std::pair<Word, Word>>{{0, 5}, {6, 5}, {1, 17}, {1, kRetiredTag}}) {
    Head lying{.first = first, .newest = newest};
    board.writer.commit(lying);
    EXPECT_FALSE(board.reader.copy_bounds(board.reader.revision(), 0, head)) << newest;
  }
}

/// One writer and several readers on one mapping, which is how ThreadSanitizer sees them. Every
/// payload says which revision it is of: all segments of one revision must agree with its head.
TEST(SegmentBoard, ThreadsReadWholeRevisionsWhileOneWrites) {
  constexpr Word kRevisions = 20'000;
  constexpr Word kSegments = 6;
  MemoryBoard board(kDimensions, 8);
  std::atomic<bool> done{false};
  std::atomic<std::size_t> torn{0};
  std::atomic<std::size_t> whole{0};
  const auto read = [&] {
    SegmentCopy copy(kDimensions);
    Head head;
    while (!done.load()) {
      const Word r = board.reader.revision();
      if (r == 0 || !board.reader.copy_head(r, head)) continue;
      if (head.consumed != r) ++torn;
      bool complete = true;
      for (Word n = kSegments; n >= 1 && complete; --n) {
        // Revision r writes the segments from 1 + r mod 3 on; others stand from r − 1 or r − 2.
        const Word seen = revision_of(board.reader, n, r, copy);
        complete = seen != 0;
        Word wanted = r;
        while (wanted > 1 && n < 1 + wanted % 3) --wanted;
        if (complete && seen != wanted) ++torn;
      }
      if (complete) ++whole;
    }
  };
  std::vector<std::thread> readers;
  for (int i = 0; i < 3; ++i) readers.emplace_back(read);
  for (Word r = 1; r <= kRevisions || whole.load() < 100; ++r) {
    for (Word n = r == 1 ? 1 : 1 + r % 3; n <= kSegments; ++n) write(board, n, r);
    Head head{.first = 1, .newest = kSegments, .consumed = r};
    board.writer.commit(head);
  }
  done = true;
  for (std::thread& reader : readers) reader.join();
  EXPECT_EQ(torn.load(), 0U);
  EXPECT_GE(whole.load(), 100U);
}

}  // namespace
}  // namespace splinecast::ipc
