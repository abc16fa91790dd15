#include "ipc/layout/header.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "ipc/layout/areas.hpp"
#include "ipc/layout/check.hpp"
#include "ipc/layout/waypoint_items.hpp"
#include "ipc/memory/names.hpp"
#include "ipc/memory/separation.hpp"
#include "ipc/options/stream.hpp"
#include "splinecast/errors.hpp"
#include "splinecast/options.hpp"
#include "tests/fixtures/streams/memory_stream.hpp"

/// Which region headers are accepted, and the error messages for the others.
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

/// Part of the expected error message, and a change that makes a header invalid.
using Spoiled = std::pair<std::string, std::function<void(RegionHeader&)>>;

std::vector<Spoiled> spoiled_headers() {
  return {
      {"magic number 1", [](RegionHeader& h) { h.magic = 1; }},
      {"byte order 67305985", [](RegionHeader& h) { h.mark.byte_order = 0x04030201; }},
      {"byte order 5", [](RegionHeader& h) { h.mark.byte_order = 5; }},
      {"layout version 9", [](RegionHeader& h) { h.mark.version = 9; }},
      {"with hash 5", [](RegionHeader& h) { h.layout_hash = 5; }},
      {"kind 2", [](RegionHeader& h) { h.kind = 2; }},
      {"dimensions 0", [](RegionHeader& h) { h.dimensions = 0; }},
      {"dimensions 65", [](RegionHeader& h) { h.dimensions = 65; }},
      {"capacity 9", [](RegionHeader& h) { h.capacity = 9; }},
      {"capacity 1", [](RegionHeader& h) { h.capacity = 1; }},
      {"capacity 1152921504606846976", [](RegionHeader& h) { h.capacity = Word{1} << 60U; }},
      {"control offset 64", [](RegionHeader& h) { h.control = 64; }},
      {"control offset 8200", [](RegionHeader& h) { h.control = kHeaderBytes + 8; }},
      {"control offset 14720", [](RegionHeader& h) { h.control = kHeaderBytes + 51 * 128; }},
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
}

TEST(Layout, AnInvalidHeaderIsRefusedWithTheOffendingValue) {
  const RegionHeader good = ring_header();
  EXPECT_NO_THROW(checked_ring_layout(good, good.region_bytes));
  for (const auto& [text, spoil] : spoiled_headers()) {
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

/// The error message for a header; empty if the header is accepted.
std::string refusal_of(const RegionHeader& header) {
  try {
    checked_ring_layout(header, header.region_bytes);
  } catch (const BadRegion& error) {
    return error.what();
  }
  return "";
}

TEST(Layout, ARegionOfAnotherVersionIsRefusedWithBothVersionsAndARemedy) {
  const std::string own = std::to_string(kLayoutVersion);
  for (const std::uint32_t version : {3U, 9U}) {
    RegionHeader header = ring_header();
    header.mark.version = version;
    header.layout_hash = 5;
    header.kind = 0;  // no other field is checked
    EXPECT_EQ(refusal_of(header),
              "region has layout version " + std::to_string(version) +
                  ", this splinecast has version " + own +
                  "; use one splinecast for all processes of the stream, or stop those of the "
                  "other version and remove its regions with `splinecast rm`");
  }
  RegionHeader header = ring_header();
  header.layout_hash = 5;
  EXPECT_EQ(refusal_of(header), "region has layout version " + own +
                                    " with hash 5, this splinecast has version " + own +
                                    " with hash " + std::to_string(layout_hash()) +
                                    "; use one build for all processes of the stream, or stop "
                                    "those of the other one and remove its regions with "
                                    "`splinecast rm`");
}

TEST(Layout, AHeaderIsReadAsItWasWritten) {
  testing::RegionBytes bytes(kBodyOffset);
  const ProducerOptions options{.dimensions = 2,
                                .names = {"left", "a name far too long for its thirty-one bytes"},
                                .units = {"rad", "m"},
                                .clock = StreamClock::recorded,
                                .start = {ConditionKind::velocity, {1, -2}}};
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
