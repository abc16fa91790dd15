#include <gtest/gtest.h>

#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "ipc/board/reader.hpp"
#include "ipc/board/writer.hpp"
#include "ipc/layout/header.hpp"
#include "ipc/layout/knot_slots.hpp"
#include "ipc/layout/waypoint_items.hpp"
#include "ipc/memory/names.hpp"
#include "ipc/options/stream.hpp"
#include "ipc/ring/reader.hpp"
#include "ipc/ring/writer.hpp"
#include "ipc/solve/stream_solver.hpp"
#include "splinecast/options.hpp"
#include "tests/fixtures/streams/memory_stream.hpp"

/// The ring and the board write the bytes that docs/layout.md shows.
namespace splinecast::ipc {
namespace {

using testing::RegionBytes;

/// The stream of the example: one dimension, two waypoints 0.1 s apart, a finish.
struct Example {
  RegionHeader ring_header = header(RegionKind::waypoints, 4);
  RegionHeader board_header = header(RegionKind::spline, 32);
  RingLayout ring_layout = RingLayout::of(1, 4, ring_header.control);
  BoardLayout board_layout = BoardLayout::of(1, 32, board_header.control, false);
  RegionBytes waypoints{ring_layout.bytes};
  RegionBytes spline{board_layout.bytes};

  Example() {
    ring_header.stride = ring_layout.stride;
    ring_header.region_bytes = ring_layout.bytes;
    board_header.stride = board_layout.stride;
    board_header.region_bytes = board_layout.bytes;
    write_header(waypoints.span(), ring_header);
    write_header(spline.span(), board_header);
    WaypointRingWriter producer(waypoints.span(), ring_layout, {});
    const WaypointRingReader ring(waypoints.span(), ring_layout);
    KnotBoardWriter board(spline.span(), board_layout);
    const KnotBoardReader published(spline.span(), board_layout);
    StreamSolver solver(ring, board, published, {}, {});
    testing::FixedClock clock;
    clock.time = Time(5);
    const auto append = [&](std::int64_t t, double x) {
      EXPECT_EQ(producer.append({Time(t), std::span(&x, 1), {}, {}}, {}), AppendStatus::accepted);
      solver.step(clock);
    };
    append(0, 1.0);
    append(100'000'000, 3.0);
    EXPECT_EQ(producer.finish({}, {}), AppendStatus::accepted);
    solver.step(clock);
  }

  static RegionHeader header(RegionKind kind, std::size_t capacity) {
    RegionHeader header = make_header({.dimensions = 1,
                                       .names = {"x"},
                                       .units = {"m"},
                                       .clock = StreamClock::recorded,
                                       .start = {}},
                                      7);
    header.kind = static_cast<std::uint64_t>(kind);
    header.capacity = capacity;
    header.epoch = 1;
    return header;
  }
};

TEST(WorkedExample, HasEveryWordThatThePageShows) {
  Example example;
  std::ifstream page(SPLINECAST_SOURCE "/docs/layout.md");
  ASSERT_TRUE(page.good());
  std::span<std::byte> region;
  std::size_t words = 0;
  for (std::string line; std::getline(page, line);) {
    if (line.find("example.waypoints:") != std::string::npos) region = example.waypoints.span();
    if (line.find("example.spline:") != std::string::npos) region = example.spline.span();
    // A row has an offset, 16 hexadecimal digits and a meaning.
    std::istringstream fields(line);
    std::size_t offset = 0;
    std::string digits;
    if (region.empty() || !(fields >> offset >> digits) || digits.size() != 16) continue;
    ASSERT_LT(offset, region.size()) << line;
    const Word found = words_at(region, offset, 1)[0];
    EXPECT_EQ(found, std::stoull(digits, nullptr, 16)) << line << "\n is " << std::hex << found;
    ++words;
  }
  EXPECT_GE(words, 40U);
}

}  // namespace
}  // namespace splinecast::ipc
