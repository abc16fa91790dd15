#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "tests/fixtures/streams/board_words.hpp"
#include "tests/fixtures/streams/memory_stream.hpp"

/// The earliest time at which the curve changed since a revision that a reader has seen.
namespace splinecast::ipc {
namespace {

using testing::MemoryBoard;

/// A board on which each revision changes the curve from a different time on.
struct Changing : MemoryBoard {
  Changing() : MemoryBoard(1, 16) {}

  /// Revision r changes the curve from 1000 − r on: the newest change is the earliest in time.
  static Time change_of(Word r) { return Time(1000) - Time(static_cast<std::int64_t>(r)); }
  void publish_to(Word revision) {
    while (writer.revision() < revision) {
      Summary summary{.first = 1, .newest = 1, .changed_from = change_of(writer.revision() + 1)};
      writer.commit(summary);
    }
  }
  /// The change that a reader which has seen revision `seen` gets for the later ones.
  Time change_since(Word seen) {
    Summary summary;
    EXPECT_TRUE(reader.copy_bounds(reader.look(), seen, summary));
    return summary.changed_from;
  }
  Word& summary_tag(std::size_t c) {
    return words_at(bytes.span(), testing::summary_offset(layout, c), 1)[0];
  }
};

TEST(RingOfChanges, ReportsTheChangeAfter63MissedRevisionsButNotAfter64) {
  for (const Word newest : {64U, 65U, 130U, 200U}) {
    Changing board;
    board.publish_to(newest);
    EXPECT_EQ(board.change_since(newest), Time::max());
    EXPECT_EQ(board.change_since(newest - 1), board.change_of(newest));
    EXPECT_EQ(board.change_since(newest - 63), board.change_of(newest));
    EXPECT_EQ(board.change_since(newest - 64), Time::min());
  }
}

TEST(RingOfChanges, ReportsTheEarliestChangeOfTheMissedRevisions) {
  MemoryBoard board(1, 16);
  for (const int change : {50, 20, 30, 40}) {
    Summary summary{.first = 1, .newest = 1, .changed_from = Time(change)};
    board.writer.commit(summary);
  }
  const auto change_since = [&](Word seen) {
    Summary summary;
    EXPECT_TRUE(board.reader.copy_bounds(board.reader.look(), seen, summary));
    return summary.changed_from;
  };
  EXPECT_EQ(change_since(0), Time(20));
  EXPECT_EQ(change_since(1), Time(20));
  EXPECT_EQ(change_since(2), Time(30));
  EXPECT_EQ(change_since(3), Time(40));
}

/// A writer that dies between storing the word of the next revision and its commit has overwritten
/// the oldest word. Its successor retires the tag, so that a reader cannot see whether that word
/// was stored.
TEST(RingOfChanges, TheWordOfAnUncommittedRevisionIsNotUsedAsTheOldestOne) {
  Changing board;
  board.publish_to(64);
  const Time before = board.change_since(1);
  const auto revision = words_at(board.bytes.span(), board.layout.control, 1);
  board.publish_to(65);
  revision[0] = 64;                               // as if the writer had died before the commit
  EXPECT_EQ(board.change_since(1), Time::min());  // its tag is valid: word 1 is overwritten
  board.replace_writer();
  EXPECT_EQ(board.change_since(1), before);  // the words of revisions 2 to 64
  EXPECT_EQ(board.change_since(0), Time::min());
}

TEST(RingOfChanges, StaysCorrectAfterADiscard) {
  Changing board;
  board.publish_to(70);
  const std::vector<double> zero(1);
  board.writer.write(1, {.is_new = true, .note = {}, .position = zero, .velocity = zero});
  board.writer.discard();
  EXPECT_EQ(board.change_since(7), board.change_of(70));
  board.publish_to(71);
  EXPECT_EQ(board.change_since(8), board.change_of(71));
  EXPECT_EQ(board.change_since(7), Time::min());
}

/// The state after two writers died in sequence while a reader read the tags.
TEST(RingOfChanges, ReportsNothingWhenBothTagsOfTheSummaryAreRetired) {
  Changing board;
  board.publish_to(10);
  Summary summary{.changed_from = Time(5)};
  for (const std::size_t c : {0U, 1U}) board.summary_tag(c) = kRetiredTag;
  EXPECT_FALSE(board.reader.copy_bounds(board.reader.look(), 9, summary));
  EXPECT_EQ(summary.changed_from, Time(5));
}

}  // namespace
}  // namespace splinecast::ipc
