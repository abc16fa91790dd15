#include "ipc/layout/areas.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <fstream>
#include <set>
#include <sstream>
#include <string>
#include <string_view>

#include "ipc/layout/board_control.hpp"
#include "ipc/layout/common_control.hpp"
#include "ipc/layout/knot_slots.hpp"
#include "ipc/layout/ring_control.hpp"
#include "ipc/layout/waypoint_items.hpp"
#include "ipc/memory/separation.hpp"
#include "ipc/options/stream.hpp"
#include "splinecast/options.hpp"

/// Offsets and sizes of the parts of regions.
namespace splinecast::ipc {
namespace {

TEST(Layout, PartsOfARegionAreInOrderAlignedAndWithinIt) {
  for (const std::size_t dimensions : {1U, 3U, 7U, 64U}) {
    const auto ring = RingLayout::of(dimensions, 1024, kHeaderBytes);
    EXPECT_GE(ring.items, ring.control + kRingControlWords * sizeof(Word));
    EXPECT_EQ(ring.stride % kCacheLine, 0U);
    EXPECT_LE(ring.items + 1024 * ring.stride, ring.bytes);
    for (const bool smooths : {false, true}) {
      const auto board = BoardLayout::of(dimensions, 4096, kHeaderBytes, smooths);
      EXPECT_GE(board.refusals, board.control + kBoardControlWords * sizeof(Word));
      EXPECT_EQ(board.excesses, board.refusals + kRefusalsKept * sizeof(Word));
      EXPECT_EQ(
          board.times,
          board.worst + kCacheLine +
              (kOutcomesKept * kOutcomeWords + 2 * kMostStoppers * kStopperWords) * sizeof(Word));
      EXPECT_EQ(board.worst, board.excesses + kExcessesKept * kExcessWords * sizeof(Word));
      EXPECT_GE(board.slots, board.times + 4096 * sizeof(Word));
      EXPECT_EQ(board.slots % kPage, 0U);
      for (const std::size_t bytes : {board.cell, board.node, board.beside_bytes, board.row}) {
        EXPECT_EQ(bytes % kCacheLine, 0U);
      }
      EXPECT_EQ(board.nodes, 2 * board.cell);
      EXPECT_EQ(board.beside, board.nodes + 2 * board.node);
      EXPECT_EQ(board.rows, board.beside + 2 * board.beside_bytes);
      EXPECT_EQ(board.stride, board.rows + 2 * board.row);
      EXPECT_LE(board.slots + 4096 * board.stride, board.bytes);
    }
  }
}

TEST(Layout, RegionsHaveTheSizesAndNumbersThatThePageStates) {
  EXPECT_EQ(RingLayout::of(7, 1024, kHeaderBytes).bytes, 212'992U);
  EXPECT_EQ(BoardLayout::of(7, 4096, kHeaderBytes, false).bytes, 2'207'744U);
  std::ifstream file(SPLINECAST_SOURCE "/docs/layout.md");
  std::ostringstream page;
  page << file.rdbuf();
  for (const std::string& said : {std::string("| 1,024 items | 212,992 bytes |"),
                                  std::string("| 4,096 knots | 2,207,744 bytes |"),
                                  "at one of " + std::to_string(kControlPositions) + " offsets",
                                  std::to_string(kPassedSlots) + " slots"}) {
    EXPECT_NE(page.str().find(said), std::string::npos) << said;
  }
}

TEST(Layout, EachPartOfASlotOfSevenDimensionsIsOneCacheLine) {
  const auto board = BoardLayout::of(7, 4096, kHeaderBytes, false);
  EXPECT_EQ(board.cell, kCacheLine);
  EXPECT_EQ(board.node, kCacheLine);
  EXPECT_EQ(board.beside_bytes, kCacheLine);
  EXPECT_EQ(board.row, kCacheLine);
  EXPECT_EQ(board.stride, 8 * kCacheLine);
}

TEST(Layout, WordsOfDifferentProcessesAreTwoCacheLinesApart) {
  const auto line = [](std::size_t word) { return word * sizeof(Word) / kSeparation; };
  EXPECT_NE(line(kWritten), line(kProducerCounters));
  for (const std::size_t word : {kConsumed, kSleeping, kSummarySlot}) {
    EXPECT_NE(line(word), line(kRevision)) << word;
  }
  EXPECT_NE(line(kConsumed), line(kSleeping));
  EXPECT_NE(line(kSleeping), line(kSummarySlot));
}

TEST(Layout, TheControlBlockOfEveryStreamIsInItsArea) {
  std::set<std::uint64_t> places;
  for (std::uint64_t id = 1; id < 200; ++id) {
    const auto header = make_header({.dimensions = 1}, id);
    EXPECT_GE(header.control, kHeaderBytes);
    EXPECT_EQ(header.control, kHeaderBytes + kSeparation * (id % kControlPositions));
    EXPECT_LE(header.control + kBoardControlWords * sizeof(Word), kBodyOffset);
    places.insert(header.control);
  }
  EXPECT_EQ(places.size(), kControlPositions);
}

/// The fields of a part are contiguous, in the order and with the sizes of its table.
TEST(Layout, TheFieldsOfEachPartAreContiguousAndHaveUniqueNames) {
  for (const LayoutPart& part : layout_parts()) {
    Extent offset;
    std::set<std::string_view> names;
    for (const Field& field : part.fields) {
      EXPECT_EQ(field.offset, offset) << part.name << ": " << field.name;
      offset = offset + field.size;
      if (field.writer == FieldWriter::padding) continue;
      EXPECT_TRUE(names.insert(field.name).second) << part.name << ": " << field.name;
      EXPECT_FALSE(field.meaning.empty()) << part.name << ": " << field.name;
    }
  }
}

}  // namespace
}  // namespace splinecast::ipc
