#pragma once

#include <cstddef>
#include <cstdlib>
#include <memory>
#include <span>
#include <string>

#include "splinecast/ipc/layout.hpp"
#include "splinecast/ipc/segment_board.hpp"
#include "splinecast/ipc/stream_solver.hpp"
#include "splinecast/ipc/waypoint_ring.hpp"

namespace splinecast::testing {

/// Zeroed, page-aligned bytes: a region without shared memory, as ring and board see it.
class RegionBytes {
 public:
  explicit RegionBytes(std::size_t size)
      : bytes_(static_cast<std::byte*>(std::aligned_alloc(ipc::kPage, size))), size_(size) {
    std::fill_n(bytes_.get(), size, std::byte{});
  }
  [[nodiscard]] std::span<std::byte> span() { return {bytes_.get(), size_}; }

 private:
  struct Free {
    void operator()(std::byte* bytes) const { std::free(bytes); }
  };
  std::unique_ptr<std::byte, Free> bytes_;
  std::size_t size_;
};

/// A ring in plain memory.
struct MemoryRing {
  ipc::RingLayout layout;
  RegionBytes bytes;
  ipc::WaypointRingWriter writer;
  ipc::WaypointRingReader reader;

  MemoryRing(std::size_t dimensions, std::size_t capacity, ipc::IngestLimits limits = {})
      : layout(ipc::RingLayout::of(dimensions, capacity, ipc::kHeaderBytes)),
        bytes(layout.bytes),
        writer(bytes.span(), layout, limits),
        reader(bytes.span(), layout) {}
};

/// A board in plain memory.
struct MemoryBoard {
  ipc::BoardLayout layout;
  RegionBytes bytes;
  ipc::SegmentBoardWriter writer;
  ipc::SegmentBoardReader reader;

  MemoryBoard(std::size_t dimensions, std::size_t capacity)
      : layout(ipc::BoardLayout::of(dimensions, capacity, ipc::kHeaderBytes)),
        bytes(layout.bytes),
        writer(bytes.span(), layout),
        reader(bytes.span(), layout) {}

  /// A writer that finds what the one before it left.
  void replace_writer() { writer = ipc::SegmentBoardWriter(bytes.span(), layout); }
};

/// A clock that stands where it is set.
class FixedClock final : public ipc::Clock {
 public:
  [[nodiscard]] core::Time now() const noexcept override { return time; }
  core::Time time{};
};

}  // namespace splinecast::testing
