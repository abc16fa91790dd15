#include "splinecast/ipc/layout.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <functional>
#include <string>
#include <vector>

#include "splinecast/ipc/errors.hpp"
#include "splinecast/ipc/stream_options.hpp"
#include "support/memory_stream.hpp"

namespace splinecast::ipc {
namespace {

RegionHeader ring_header() {
  RegionHeader header = make_header({.dimensions = 2}, 77);
  header.kind = static_cast<std::uint64_t>(RegionKind::waypoints);
  header.capacity = 8;
  const auto layout = RingLayout::of(2, 8, header.control);
  header.stride = layout.stride;
  header.region_bytes = layout.bytes;
  return header;
}

TEST(Layout, PartsOfARegionFollowEachOtherAlignedAndWithinIt) {
  for (const std::size_t dimensions : {1U, 3U, 7U, 64U}) {
    const auto ring = RingLayout::of(dimensions, 1024, kHeaderBytes);
    EXPECT_GE(ring.items, ring.control + kControlLines * kSeparation);
    EXPECT_EQ(ring.stride % kCacheLine, 0U);
    EXPECT_LE(ring.items + 1024 * ring.stride, ring.bytes);
    const auto board = BoardLayout::of(dimensions, 4096, kHeaderBytes);
    EXPECT_GE(board.head, kBodyOffset);
    EXPECT_EQ(board.refusals, board.head + 2 * kHeadWords * sizeof(Word));
    EXPECT_EQ(board.times, board.refusals + kRefusalsKept * sizeof(Word));
    EXPECT_GE(board.slots, board.times + 4096 * sizeof(Word));
    EXPECT_EQ(board.slots % kPage, 0U);
    EXPECT_EQ(board.cell % kCacheLine, 0U);
    EXPECT_EQ(board.stride, 2 * board.cell);
    EXPECT_LE(board.slots + 4096 * board.stride, board.bytes);
  }
}

TEST(Layout, TheControlLinesOfEveryStreamLieInTheirPage) {
  for (std::uint64_t id = 1; id < 100; ++id) {
    const auto header = make_header({.dimensions = 1}, id);
    EXPECT_GE(header.control, kHeaderBytes);
    EXPECT_LE(header.control + kControlLines * kSeparation, kBodyOffset);
  }
}

TEST(Layout, AHeaderThatSaysSomethingElseIsRefusedWithTheValue) {
  const RegionHeader good = ring_header();
  EXPECT_NO_THROW(checked_ring_layout(good, good.region_bytes));
  const std::vector<std::pair<std::string, std::function<void(RegionHeader&)>>> cases{
      {"magic number 1", [](RegionHeader& h) { h.magic = 1; }},
      {"byte order 67305985", [](RegionHeader& h) { h.byte_order = 0x04030201; }},
      {"layout version 9", [](RegionHeader& h) { h.layout_version = 9; }},
      {"layout hash 5", [](RegionHeader& h) { h.layout_hash = 5; }},
      {"kind 2", [](RegionHeader& h) { h.kind = 2; }},
      {"dimensions 0", [](RegionHeader& h) { h.dimensions = 0; }},
      {"dimensions 65", [](RegionHeader& h) { h.dimensions = 65; }},
      {"order 4", [](RegionHeader& h) { h.order = 4; }},
      {"capacity 9", [](RegionHeader& h) { h.capacity = 9; }},
      {"capacity 1", [](RegionHeader& h) { h.capacity = 1; }},
      {"capacity 1152921504606846976", [](RegionHeader& h) { h.capacity = Word{1} << 60U; }},
      {"control offset 64", [](RegionHeader& h) { h.control = 64; }},
      {"control offset 8200", [](RegionHeader& h) { h.control = kHeaderBytes + 8; }},
      {"clock 7", [](RegionHeader& h) { h.clock = 7; }},
      {"item size 8", [](RegionHeader& h) { h.stride = 8; }},
      {"kind of dimension 4", [](RegionHeader& h) { h.dimension_kind[1] = 4; }},
      {"period nan",
       [](RegionHeader& h) {
         h.dimension_kind[1] = 1;
         h.period[1] = std::nan("");
       }},
      {"dimension 0 has period 2", [](RegionHeader& h) { h.period[0] = 2; }},
      {"at dimension 0 does not have four dimensions",
       [](RegionHeader& h) { h.dimension_kind[0] = h.dimension_kind[1] = 2; }},
      {"size",
       [](RegionHeader& h) {
         h.capacity = 16;
         h.region_bytes = 4096;
       }},
  };
  for (const auto& [text, spoil] : cases) {
    RegionHeader bad = good;
    spoil(bad);
    try {
      checked_ring_layout(bad, good.region_bytes);
      ADD_FAILURE() << text << " was accepted";
    } catch (const BadRegion& error) {
      EXPECT_NE(std::string(error.what()).find(text), std::string::npos) << error.what();
    }
  }
  EXPECT_THROW(checked_ring_layout(good, good.region_bytes - kPage), BadRegion);
  EXPECT_THROW(checked_ring_layout(good, good.region_bytes + kPage), BadRegion);
  EXPECT_THROW(checked_board_layout(good, good.region_bytes), BadRegion);
}

TEST(Layout, AHeaderComesBackAsItWasWritten) {
  testing::RegionBytes bytes(kBodyOffset);
  const ProducerOptions options{.dimensions = 2,
                                .names = {"left", "a name far too long for its thirty-one bytes"},
                                .units = {"rad", "m"},
                                .clock = StreamClock::recorded,
                                .start = {core::ConditionKind::velocity, {1, -2}}};
  write_header(bytes.span(), make_header(options, 5));
  const RegionHeader header = copy_header(bytes.span());
  EXPECT_EQ(header.stream_id, 5U);
  EXPECT_EQ(start_condition(header), options.start);
  EXPECT_EQ(stream_clock(header), StreamClock::recorded);
  EXPECT_EQ(dimension_names(header)[0], "left");
  EXPECT_EQ(dimension_names(header)[1], std::string(options.names[1]).substr(0, 31));
  EXPECT_EQ(dimension_units(header), options.units);
  EXPECT_THROW((void)copy_header(bytes.span().first(100)), BadRegion);
}

}  // namespace
}  // namespace splinecast::ipc
