#pragma once

#include <cstddef>
#include <cstdlib>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "splinecast/ipc/knot_board.hpp"
#include "splinecast/ipc/layout.hpp"
#include "splinecast/ipc/stream_solver.hpp"
#include "splinecast/ipc/waypoint_ring.hpp"
#include "support/mesh.hpp"

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
  ipc::KnotBoardWriter writer;
  ipc::KnotBoardReader reader;

  MemoryBoard(std::size_t dimensions, std::size_t capacity, bool smooths = false)
      : layout(ipc::BoardLayout::of(dimensions, capacity, ipc::kHeaderBytes, smooths)),
        bytes(layout.bytes),
        writer(bytes.span(), layout),
        reader(bytes.span(), layout) {}

  /// A writer that finds what the one before it left.
  void replace_writer() { writer = ipc::KnotBoardWriter(bytes.span(), layout); }
};

/// A clock that stands where it is set.
class FixedClock final : public ipc::Clock {
 public:
  [[nodiscard]] core::Time now() const noexcept override { return time; }
  core::Time time{};
};

/// A whole stream in plain memory: ring, board and solver.
struct MemoryStream {
  MemoryRing ring;
  MemoryBoard board;
  core::WindowOptions window;
  ipc::IngestLimits limits;
  core::DimensionKinds kinds;
  std::optional<ipc::LiveOptions> live;
  core::Beyond beyond = core::Beyond::report;  ///< of the next solver
  ipc::StreamSolver solver;
  FixedClock clock;

  explicit MemoryStream(std::size_t dimensions, core::WindowOptions how = {},
                        std::size_t ring_capacity = 64, std::size_t board_capacity = 1024,
                        ipc::IngestLimits solver_limits = {},
                        core::DimensionKinds dimension_kinds = {},
                        std::optional<ipc::LiveOptions> how_live = {})
      : ring(dimensions, ring_capacity),
        board(dimensions, board_capacity,
              how.interpolant.method->family == core::Family::smoothing),
        window(how),
        limits(solver_limits),
        kinds(std::move(dimension_kinds)),
        live(how_live),
        solver(ring.reader, board.writer, board.reader, window, limits, kinds, live) {}

  ipc::AppendStatus append(const core::Waypoint& waypoint) {
    return ring.writer.append(waypoint, {board.reader.tail()});
  }
  ipc::AppendStatus append(core::Time t, std::span<const double> x) {
    return append({.time = t, .position = x});
  }
  /// Appends a waypoint, letting the solver work where the ring is full.
  void send(const core::Waypoint& waypoint) {
    while (append(waypoint) == ipc::AppendStatus::full) solver.step(clock);
  }
  void send(const Mesh& mesh, std::size_t from, std::size_t to) {
    for (std::size_t i = from; i < to; ++i) send({mesh.times[i], mesh.position(i), {}, {}});
  }
  void finish(const core::Condition& end = {}) {
    while (ring.writer.finish(end, {board.reader.tail()}) == ipc::AppendStatus::full) {
      solver.step(clock);
    }
    drain();
  }
  void drain() {
    while (solver.step(clock).consumed > 0) {
    }
  }
  /// What happens when the producer is killed and another one comes.
  void replace_producer() {
    ring.writer = ipc::WaypointRingWriter(ring.bytes.span(), ring.layout, limits);
  }
  /// What happens when the solver is killed and another one comes.
  void replace_solver() {
    board.replace_writer();
    solver = ipc::StreamSolver(ring.reader, board.writer, board.reader, window, limits, kinds, live,
                               beyond);
  }
};

}  // namespace splinecast::testing
