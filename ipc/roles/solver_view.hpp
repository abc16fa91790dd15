#pragma once

#include <memory>
#include <utility>

#include "ipc/board/reader.hpp"
#include "ipc/layout/header.hpp"
#include "ipc/layout/knot_slots.hpp"
#include "ipc/layout/waypoint_items.hpp"
#include "ipc/mapping/region.hpp"
#include "ipc/ring/reader.hpp"
#include "ipc/roles/replace_preview.hpp"

namespace splinecast::ipc {

/// The solver's region as the producer maps it. It holds the ring's consumed position.
struct SolverView {
  Region region;
  RegionHeader header;
  KnotBoardReader board;
  std::unique_ptr<ReplacementPlanner> planner;  ///< once a replacement has been previewed

  SolverView(Region mapped, const RegionHeader& described, const BoardLayout& layout)
      : region(std::move(mapped)), header(described), board(region.bytes(), layout) {
    region.close_descriptor();
  }
};

/// The producer's region, as the solver reads it.
struct RingView {
  Region region;
  RegionHeader header;
  WaypointRingReader ring;

  RingView(Region mapped, const RegionHeader& described, const RingLayout& layout)
      : region(std::move(mapped)), header(described), ring(region.bytes(), layout) {
    region.close_descriptor();
  }
};

}  // namespace splinecast::ipc
