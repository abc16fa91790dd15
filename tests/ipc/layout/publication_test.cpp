#include "ipc/layout/publication.hpp"

#include <gtest/gtest.h>

#include <array>

namespace splinecast::ipc {
namespace {

constexpr std::size_t kCellWords = 4;

constexpr Word tag_of(Word revision) { return revision << kTagRevisionShift; }

struct Slot {
  std::array<Word, 2 * kCellWords> words{};
  SlotView<Word> writing() { return {words.data(), kCellWords}; }
  [[nodiscard]] SlotView<const Word> reading() const { return {words.data(), kCellWords}; }
  [[nodiscard]] Tags tags() const { return reading().tags(std::memory_order_acquire); }

  /// Writes revision r into the cell that `committed` does not use.
  void write(Word r, Word committed, Word payload) {
    Word* const cell = writing().cell(1 - tags().newest(committed));
    store(cell[0], tag_of(r), std::memory_order_release);
    for (std::size_t i = 1; i < kCellWords; ++i) put(cell[i], payload + i);
  }
  /// The payload as seen under revision r, or 0.
  [[nodiscard]] Word read(Word r) const {
    if (!tags().holds_any(r)) return 0;
    const Word* const cell = reading().cell(tags().newest(r));
    EXPECT_EQ(cell[2], cell[1] + 1);
    EXPECT_EQ(cell[3], cell[1] + 2);
    return cell[1] - 1;
  }
};

TEST(Publication, TheNewestCellHasTheLargestRevisionUpToTheRequestedOne) {
  EXPECT_EQ((Tags{{tag_of(3), tag_of(5)}}.newest(5)), 1U);
  EXPECT_EQ((Tags{{tag_of(3), tag_of(5)}}.newest(4)), 0U);
  EXPECT_EQ((Tags{{tag_of(7), tag_of(5)}}.newest(6)), 1U);
  EXPECT_EQ((Tags{{kRetiredTag, tag_of(2)}}.newest(9)), 1U);
  EXPECT_EQ((Tags{{tag_of(2), kRetiredTag}}.newest(kLastRevision)), 0U);
  EXPECT_FALSE((Tags{{0, 0}}.holds_any(9)));
  EXPECT_FALSE((Tags{{0, tag_of(5)}}.holds_any(4)));
  EXPECT_FALSE((Tags{{kRetiredTag, kRetiredTag}}.holds_any(kLastRevision)));
}

TEST(Publication, TheLowerBitsOfATagDoNotDecideWhichCellIsNewest) {
  constexpr Word kBits = (Word{1} << kTagRevisionShift) - 1;
  EXPECT_EQ((Tags{{tag_of(5) | kBits, tag_of(6)}}.newest(6)), 1U);
  EXPECT_EQ((Tags{{tag_of(5) | kBits, tag_of(6)}}.newest(5)), 0U);
  EXPECT_TRUE((Tags{{0, tag_of(5) | kBits}}.holds_any(5)));
  EXPECT_FALSE((Tags{{0, tag_of(5) | kBits}}.holds_any(4)));
}

TEST(Publication, ARevisionIsVisibleFromItsNumberOnAndKeepsThePreviousOne) {
  Slot slot;
  EXPECT_EQ(slot.read(10), 0U);
  slot.write(1, 0, 100);
  EXPECT_EQ(slot.read(0), 0U);
  EXPECT_EQ(slot.read(1), 100U);
  slot.write(2, 1, 200);
  EXPECT_EQ(slot.read(1), 100U);
  EXPECT_EQ(slot.read(2), 200U);
  EXPECT_EQ(slot.read(9), 200U);
  slot.write(5, 4, 500);
  EXPECT_EQ(slot.read(4), 200U);
  EXPECT_EQ(slot.read(5), 500U);
}

TEST(Publication, ACopyIsTheNewestUntilANewerOneIsCommittedToItsSlot) {
  Slot slot;
  slot.write(1, 0, 100);
  slot.write(2, 1, 200);
  const std::size_t own = slot.tags().newest(2);
  EXPECT_TRUE(is_newest(slot.reading(), own, tag_of(2), 2));
  EXPECT_TRUE(is_newest(slot.reading(), own, tag_of(2), 9));
  slot.write(3, 2, 300);
  EXPECT_TRUE(is_newest(slot.reading(), own, tag_of(2), 2));  // not committed yet
  EXPECT_FALSE(is_newest(slot.reading(), own, tag_of(2), 3));
  slot.write(4, 3, 400);  // overwrites the cell of the copy
  EXPECT_FALSE(is_newest(slot.reading(), own, tag_of(2), 2));
  EXPECT_FALSE(is_newest(slot.reading(), own, tag_of(2), 3));
}

TEST(Publication, ACopyWhoseTagDiffersInItsLowerBitsOnlyIsNotTheNewest) {
  Slot slot;
  slot.write(1, 0, 100);
  const std::size_t own = slot.tags().newest(1);
  EXPECT_FALSE(is_newest(slot.reading(), own, tag_of(1) | 1, 1));
}

TEST(Publication, AnUncommittedCellIsRetiredAndNeverBecomesTheNewest) {
  Slot slot;
  slot.write(1, 0, 100);
  slot.write(2, 1, 200);  // not committed: the writer died
  retire_uncommitted(slot.writing(), 1);
  for (const Word r : {1U, 2U, 3U, 1000U}) EXPECT_EQ(slot.read(r), 100U) << r;
  slot.write(2, 1, 300);
  EXPECT_EQ(slot.read(1), 100U);
  EXPECT_EQ(slot.read(2), 300U);
}

}  // namespace
}  // namespace splinecast::ipc
