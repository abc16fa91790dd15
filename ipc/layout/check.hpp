#pragma once

#include <cstddef>

#include "ipc/layout/commander_control.hpp"
#include "ipc/layout/header.hpp"
#include "ipc/layout/knot_slots.hpp"
#include "ipc/layout/waypoint_items.hpp"

namespace splinecast::ipc {

/// Returns the layout that a copied header describes. Throws BadRegion, naming the offending value,
/// unless the header has the right kind, layout version and byte order, valid values, and the size
/// `real_bytes` of the file.
RingLayout checked_ring_layout(const RegionHeader& header, std::size_t real_bytes);
BoardLayout checked_board_layout(const RegionHeader& header, std::size_t real_bytes);
CommanderLayout checked_commander_layout(const RegionHeader& header, std::size_t real_bytes);

}  // namespace splinecast::ipc
