#pragma once

#include <cstddef>

#include "ipc/layout/header.hpp"
#include "ipc/layout/knot_slots.hpp"
#include "ipc/layout/waypoint_items.hpp"

namespace splinecast::ipc {

/// Throws BadRegion, naming the offending value, unless the copied header describes a region of
/// this kind, layout, byte order and real size. Returns its layout.
RingLayout checked_ring_layout(const RegionHeader& header, std::size_t real_bytes);
BoardLayout checked_board_layout(const RegionHeader& header, std::size_t real_bytes);

}  // namespace splinecast::ipc
