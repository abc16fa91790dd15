#include "splinecast/ipc/publication.hpp"

#include <gtest/gtest.h>

#include <array>

namespace splinecast::ipc {
namespace {

constexpr std::size_t kCellWords = 4;

struct Slot {
  std::array<Word, 2 * kCellWords> words{};
  SlotView<Word> writing() { return {words.data(), kCellWords}; }
  SlotView<const Word> reading() { return {words.data(), kCellWords}; }

  void write(Word r, Word payload) {
    Word* const cell = claim_spare(writing(), r);
    for (std::size_t i = 1; i < kCellWords; ++i) put(cell[i], payload + i);
  }
  /// The payload under r, or 0.
  Word read(Word r) {
    std::array<Word, kCellWords - 1> copy{};
    if (copy_newest(reading(), r, copy.size(), copy.data()) == 0) return 0;
    EXPECT_EQ(copy[1], copy[0] + 1);
    EXPECT_EQ(copy[2], copy[0] + 2);
    return copy[0] - 1;
  }
};

TEST(Publication, TheNewestCellIsTheOneWithTheLargestTagNotAboveTheRevision) {
  EXPECT_EQ((Tags{{3, 5}}.newest(5)), 1U);
  EXPECT_EQ((Tags{{3, 5}}.newest(4)), 0U);
  EXPECT_EQ((Tags{{7, 5}}.newest(6)), 1U);
  EXPECT_EQ((Tags{{kRetiredTag, 2}}.newest(9)), 1U);
  EXPECT_FALSE((Tags{{0, 0}}.holds_any(9)));
  EXPECT_FALSE((Tags{{0, 5}}.holds_any(4)));
  EXPECT_FALSE((Tags{{kRetiredTag, kRetiredTag}}.holds_any(9)));
}

TEST(Publication, ARevisionIsSeenOnlyUnderItsNumberAndLeavesTheOneBeforeIt) {
  Slot slot;
  EXPECT_EQ(slot.read(10), 0U);
  slot.write(1, 100);
  EXPECT_EQ(slot.read(0), 0U);
  EXPECT_EQ(slot.read(1), 100U);
  slot.write(2, 200);
  EXPECT_EQ(slot.read(1), 100U);
  EXPECT_EQ(slot.read(2), 200U);
  EXPECT_EQ(slot.read(9), 200U);
  slot.write(5, 500);
  EXPECT_EQ(slot.read(4), 200U);
  EXPECT_EQ(slot.read(5), 500U);
}

TEST(Publication, ASecondWriteOfOneRevisionGoesToTheSameCell) {
  Slot slot;
  slot.write(1, 100);
  slot.write(2, 200);
  slot.write(2, 210);
  EXPECT_EQ(slot.read(1), 100U);
  EXPECT_EQ(slot.read(2), 210U);
}

TEST(Publication, WhatWasNotCommittedIsRetiredAndNeverComesToBeTheNewest) {
  Slot slot;
  slot.write(1, 100);
  slot.write(2, 200);  // not committed: the writer died
  retire_uncommitted(slot.writing(), 1);
  for (const Word r : {1U, 2U, 3U, 1000U}) EXPECT_EQ(slot.read(r), 100U) << r;
  slot.write(2, 300);
  EXPECT_EQ(slot.read(1), 100U);
  EXPECT_EQ(slot.read(2), 300U);
}

}  // namespace
}  // namespace splinecast::ipc
