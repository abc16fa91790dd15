#include "ipc/board/knot.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <span>
#include <thread>
#include <vector>

#include "ipc/board/reader.hpp"
#include "ipc/layout/summary.hpp"
#include "tests/fixtures/streams/board_words.hpp"
#include "tests/fixtures/streams/memory_stream.hpp"

/// Which knots a reader finds on a board, and in which revision.
namespace splinecast::ipc {
namespace {

using core::SegmentForm;
using testing::MemoryBoard;

constexpr std::size_t kDimensions = 3;

Time time_of(Word number) { return Time(static_cast<std::int64_t>(number) * 100); }

std::vector<double> all(double value) { return std::vector<double>(kDimensions, value); }

/// Writes a knot whose position is its number and whose velocity is its revision.
void write(MemoryBoard& board, Word number, bool is_new = false) {
  const auto velocity = all(static_cast<double>(board.writer.revision() + 1));
  const auto position = all(static_cast<double>(number));
  board.writer.write(number, {.is_new = is_new,
                              .note = {.form = SegmentForm::cubic, .is_waypoint = true},
                              .time = time_of(number),
                              .position = position,
                              .velocity = velocity});
}

void commit(MemoryBoard& board, Word first, Word newest) {
  Summary summary{.first = first, .newest = newest};
  board.writer.commit(summary);
}

bool are_all(std::span<const double> values, double value) {
  return std::ranges::all_of(values, [=](double each) { return each == value; });
}

/// The revision that wrote knot `number`, as seen under revision r; 0 if the knot cannot be copied,
/// kRetiredTag if the copy is torn.
Word revision_of_knot(const KnotBoardReader& board, Word number, Word r, KnotCopy& copy) {
  if (!board.copy_knot(number, r, copy)) return 0;
  const auto revision = static_cast<Word>(copy.velocity()[0]);
  const bool is_whole = are_all(copy.velocity(), static_cast<double>(revision)) &&
                        are_all(copy.waypoint(), static_cast<double>(number)) &&
                        copy.time == time_of(number) && revision_of(copy.tag) == revision;
  return is_whole ? revision : kRetiredTag;
}

TEST(KnotBoard, ARevisionAppearsAtomicallyAndThePreviousOneStaysReadable) {
  MemoryBoard board(kDimensions, 16);
  KnotCopy copy(kDimensions, false);
  Summary summary;
  EXPECT_EQ(board.reader.revision(), 0U);
  EXPECT_FALSE(board.reader.copy_summary({}, summary));
  for (Word n = 1; n <= 5; ++n) write(board, n, true);
  EXPECT_EQ(board.reader.revision(), 0U);
  commit(board, 1, 5);
  ASSERT_EQ(board.reader.revision(), 1U);
  for (Word n = 3; n <= 6; ++n) write(board, n, n == 6);
  for (Word n = 1; n <= 5; ++n) EXPECT_EQ(revision_of_knot(board.reader, n, 1, copy), 1U) << n;
  commit(board, 1, 6);
  for (Word n = 1; n <= 6; ++n) {
    EXPECT_EQ(revision_of_knot(board.reader, n, 2, copy), n < 3 ? 1U : 2U) << n;
    EXPECT_EQ(revision_of_knot(board.reader, n, 1, copy), n < 6 ? 1U : 0U) << n;
  }
  ASSERT_TRUE(board.reader.copy_summary({.settled_until = {}, .revision = 1}, summary));
  EXPECT_EQ(summary.newest, 5U);
  ASSERT_TRUE(board.reader.copy_summary({.settled_until = {}, .revision = 2}, summary));
  EXPECT_EQ(summary.newest, 6U);
}

TEST(KnotBoard, ACopyIsCurrentUntilItsKnotIsRepublished) {
  MemoryBoard board(kDimensions, 16);
  KnotCopy copy(kDimensions, false);
  write(board, 1, true);
  write(board, 2, true);
  commit(board, 1, 2);
  ASSERT_EQ(revision_of_knot(board.reader, 1, 1, copy), 1U);
  write(board, 2);
  commit(board, 1, 2);
  EXPECT_TRUE(board.reader.is_current(copy, 2));
  write(board, 1);
  EXPECT_TRUE(board.reader.is_current(copy, 2));
  commit(board, 1, 2);
  EXPECT_FALSE(board.reader.is_current(copy, 3));
}

TEST(KnotBoard, ANewWriterRetiresTheTagsThatTheDeadWriterDidNotCommit) {
  MemoryBoard board(kDimensions, 16);
  KnotCopy copy(kDimensions, false);
  for (Word n = 1; n <= 3; ++n) write(board, n, true);
  commit(board, 1, 3);
  write(board, 2);
  write(board, 3);  // and dies
  board.replace_writer();
  for (Word r = 1; r <= 4; ++r) {
    for (Word n = 1; n <= 3; ++n) EXPECT_EQ(revision_of_knot(board.reader, n, r, copy), 1U);
  }
  write(board, 3);
  commit(board, 1, 3);
  EXPECT_EQ(revision_of_knot(board.reader, 2, 2, copy), 1U);
  EXPECT_EQ(revision_of_knot(board.reader, 3, 2, copy), 2U);
}

TEST(KnotBoard, ASlotHoldsSuccessiveKnotsOverManyRounds) {
  constexpr Word kCapacity = 4;
  MemoryBoard board(kDimensions, kCapacity);
  KnotCopy copy(kDimensions, false);
  for (Word n = 1; n <= 40; ++n) {
    // Each append republishes the previous knot, as solvers do. So a slot is written twice per
    // knot: both writes switch its cell, but only the first one switches its node.
    if (n > 1) write(board, n - 1);
    write(board, n, true);
    commit(board, n > kCapacity ? n - kCapacity + 1 : 1, n);
    for (Word back = 0; back < kCapacity && back < n; ++back) {
      const Word last_written = back == 0 ? n : n - back + 1;
      EXPECT_EQ(revision_of_knot(board.reader, n - back, n, copy), last_written) << n;
    }
    // Revision n has written the slot of knot n - kCapacity once, so that in the previous revision
    // this old knot is still complete.
    if (n > kCapacity) {
      EXPECT_EQ(revision_of_knot(board.reader, n - kCapacity, n - 1, copy), n - kCapacity + 1);
    }
  }
}

TEST(KnotBoard, ACopyIsNotCurrentWhenANewerKnotReusesItsNode) {
  constexpr Word kCapacity = 4;
  MemoryBoard board(kDimensions, kCapacity);
  KnotCopy old(kDimensions, false);
  KnotCopy copy(kDimensions, false);
  write(board, 1, true);
  commit(board, 1, 1);
  ASSERT_TRUE(board.reader.copy_knot(1, 1, old));
  for (const Word n : {1 + kCapacity, 1 + 2 * kCapacity}) {
    write(board, n, true);
    commit(board, n, n);
  }
  ASSERT_EQ(revision_of_knot(board.reader, 1 + 2 * kCapacity, 3, copy), 3U);
  EXPECT_EQ(copy.tag & 1, old.tag & 1);  // the node
  EXPECT_EQ(copy.cell, old.cell);
  EXPECT_FALSE(board.reader.is_current(old, 3));
}

TEST(KnotBoard, RepublishingAKnotDoesNotWriteItsNode) {
  MemoryBoard board(kDimensions, 4);
  write(board, 1, true);
  commit(board, 1, 1);
  const auto words = words_at(board.bytes.span(), testing::node_offset(board.layout, 1, 0),
                              2 * board.layout.node / sizeof(Word));
  const std::vector<Word> before(words.begin(), words.end());
  for (int i = 0; i < 5; ++i) {
    write(board, 1);
    commit(board, 1, 1);
  }
  EXPECT_TRUE(std::ranges::equal(words, before));
}

TEST(KnotBoard, ADiscardedRevisionChangesNoKnotNoTimeAndNoLaterRevision) {
  constexpr Word kCapacity = 4;
  MemoryBoard board(kDimensions, kCapacity);
  KnotCopy copy(kDimensions, false);
  for (Word n = 1; n <= kCapacity; ++n) write(board, n, true);
  commit(board, 1, kCapacity);
  write(board, 3);
  board.writer.write_form(4, SegmentForm::none, time_of(9));
  write(board, 5, true);  // over knot 1
  board.writer.discard();
  for (Word r = 1; r <= 3; ++r) {
    for (Word n = 1; n <= kCapacity; ++n) {
      EXPECT_EQ(revision_of_knot(board.reader, n, r, copy), 1U) << n;
      EXPECT_EQ(board.reader.time_hint(n), time_of(n)) << n;
      EXPECT_EQ(board.writer.form(n), SegmentForm::cubic) << n;
    }
  }
  write(board, 4);
  write(board, 5, true);
  commit(board, 2, 5);
  EXPECT_EQ(revision_of_knot(board.reader, 3, 2, copy), 1U);
  EXPECT_EQ(revision_of_knot(board.reader, 4, 2, copy), 2U);
  EXPECT_EQ(revision_of_knot(board.reader, 5, 2, copy), 2U);
  EXPECT_EQ(revision_of_knot(board.reader, 1, 1, copy), 1U);
}

TEST(KnotBoard, ADiscardedRevisionKeepsTheRowOfTheCommittedKnot) {
  MemoryBoard board(kDimensions, 4);
  KnotCopy copy(kDimensions, false);
  const auto zeros = all(0);
  const auto write_row = [&](double value) {
    const core::Prefix prefix{.gamma = value};
    const auto g = all(value);
    board.writer.write(1, {.is_new = board.writer.revision() == 0,
                           .note = {.form = SegmentForm::cubic},
                           .time = time_of(1),
                           .position = zeros,
                           .velocity = zeros,
                           .prefix = &prefix,
                           .g = g});
  };
  const auto expect_row = [&](double value) {
    std::vector<double> g(kDimensions);
    ASSERT_TRUE(board.reader.copy_knot(1, board.reader.revision(), copy));
    EXPECT_EQ(board.reader.copy_row(copy, g).gamma, value);
    EXPECT_TRUE(are_all(g, value));
  };
  for (int round = 1; round <= 6; ++round) {
    write_row(round);
    commit(board, 1, 1);
    expect_row(round);
    write_row(-round);
    expect_row(round);
    if (round % 2 == 0) {
      board.writer.discard();
    } else {
      board.replace_writer();
    }
    expect_row(round);
    if (round % 3 != 0) continue;
    write(board, 1);  // without a row: the knot keeps its row
    commit(board, 1, 1);
    expect_row(round);
  }
}

TEST(KnotBoard, RewritingAFormKeepsTheRestOfTheKnotAndUpdatesThePackedTime) {
  for (const bool smooths : {false, true}) {
    MemoryBoard board(kDimensions, 8, smooths);
    const auto position = all(1);
    const auto velocity = all(2);
    const auto acceleration = all(3);
    const auto residual = all(4);
    board.writer.write(
        1, {.is_new = true,
            .note = {.form = SegmentForm::entry, .starts = true, .newer_knots = 5},
            .time = time_of(1),
            .position = position,
            .velocity = velocity,
            .acceleration = acceleration,
            .residual = smooths ? std::span<const double>(residual) : std::span<const double>(),
            .item = 17});
    commit(board, 1, 1);
    KnotCopy copy(kDimensions, smooths);
    for (int round = 0; round < 4; ++round) {
      const bool is_end = round % 2 == 0;
      board.writer.write_form(1, is_end ? SegmentForm::none : SegmentForm::entry, time_of(7));
      EXPECT_EQ(board.writer.form(1), is_end ? SegmentForm::none : SegmentForm::entry);
      commit(board, 1, 1);
      ASSERT_TRUE(board.reader.copy_knot(1, board.reader.revision(), copy));
      EXPECT_EQ(copy.note.form, is_end ? SegmentForm::none : SegmentForm::entry);
      EXPECT_TRUE(copy.note.starts);
      EXPECT_EQ(copy.note.newer_knots, 5U);
      EXPECT_EQ(copy.item, 17U);
      EXPECT_EQ(copy.time, time_of(1));
      EXPECT_TRUE(are_all(copy.waypoint(), 1) && are_all(copy.velocity(), 2) &&
                  are_all(copy.acceleration(), 3));
      if (smooths) {
        EXPECT_TRUE(are_all(copy.residual(), 4));
      }
      EXPECT_EQ(board.reader.time_hint(1), time_of(7));
    }
  }
}

TEST(KnotBoard, ANewWriterRestoresThePackedTimesOfTheCommittedKnots) {
  constexpr Word kCapacity = 4;
  MemoryBoard board(kDimensions, kCapacity);
  for (Word n = 1; n <= kCapacity; ++n) write(board, n, true);
  commit(board, 1, kCapacity);
  board.writer.write_form(3, SegmentForm::none, time_of(4));
  commit(board, 1, kCapacity);
  write(board, 5, true);
  board.writer.write_form(2, SegmentForm::none, time_of(9));  // and dies
  EXPECT_EQ(board.reader.time_hint(2), time_of(9));
  board.replace_writer();
  EXPECT_EQ(board.reader.time_hint(1), time_of(1));
  EXPECT_EQ(board.reader.time_hint(2), time_of(2));
  EXPECT_EQ(board.reader.time_hint(3), time_of(4));  // no segment begins there
  EXPECT_EQ(board.reader.time_hint(4), time_of(4));
}

/// Counts complete and torn revisions that several readers see while the board is written. Revision
/// r has the knots from r on, the last of which is new, and writes the knots from r + r mod 3 on.
class Readers {
 public:
  explicit Readers(const KnotBoardReader& board) : board_(board) {}

  /// Reads until `stop` is called.
  void read() {
    KnotCopy copy(kDimensions, false);
    Summary summary;
    while (!done_.load()) {
      const Look look = board_.look();
      const Word r = look.revision;
      if (r == 0 || !board_.copy_summary(look, summary)) continue;
      if (summary.consumed != r || summary.first != r) ++torn_;
      bool complete = true;
      for (Word n = summary.newest; n >= summary.first && complete; --n) {
        const Word seen = revision_of_knot(board_, n, r, copy);
        complete = seen != 0;
        Word wanted = r;
        while (wanted > 1 && n < wanted + wanted % 3) --wanted;
        if (complete && seen != wanted) ++torn_;
      }
      if (complete) ++whole_;
    }
  }
  void stop() { done_ = true; }
  [[nodiscard]] std::size_t torn() const { return torn_.load(); }
  [[nodiscard]] std::size_t whole() const { return whole_.load(); }

 private:
  const KnotBoardReader& board_;
  std::atomic<bool> done_{false};
  std::atomic<std::size_t> torn_{0};
  std::atomic<std::size_t> whole_{0};
};

/// One writer and several readers use one mapping, so that ThreadSanitizer sees their accesses.
/// Every payload contains its revision and knot number: all knots of one revision must agree with
/// its summary.
TEST(KnotBoard, ThreadsReadWholeRevisionsWhileOneWrites) {
  constexpr Word kRevisions = 20'000;
  constexpr Word kKnots = 6;
  MemoryBoard board(kDimensions, 8);
  Readers reading(board.reader);
  std::vector<std::thread> readers;
  for (int i = 0; i < 3; ++i) readers.emplace_back([&] { reading.read(); });
  for (Word r = 1; r <= kRevisions || reading.whole() < 100; ++r) {
    const Word newest = r + kKnots - 1;
    for (Word n = r == 1 ? 1 : r + r % 3; n <= newest; ++n) write(board, n, r == 1 || n == newest);
    Summary summary{.first = r, .newest = newest, .consumed = r};
    board.writer.commit(summary);
  }
  reading.stop();
  for (std::thread& reader : readers) reader.join();
  EXPECT_EQ(reading.torn(), 0U);
  EXPECT_GE(reading.whole(), 100U);
}

}  // namespace
}  // namespace splinecast::ipc
