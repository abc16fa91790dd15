#pragma once

#include <cstddef>

#include "ipc/layout/header.hpp"
#include "ipc/layout/knot_slots.hpp"
#include "ipc/layout/request_control.hpp"
#include "ipc/layout/waypoint_items.hpp"
#include "ipc/memory/names.hpp"

namespace splinecast::ipc {

/// Returns the layout that a copied header describes. Throws BadRegion, naming the offending value,
/// unless the header has the right kind, layout version and byte order, valid values, and the size
/// `real_bytes` of the file.
RingLayout checked_ring_layout(const RegionHeader& header, std::size_t real_bytes);
BoardLayout checked_board_layout(const RegionHeader& header, std::size_t real_bytes);
RequestLayout checked_request_layout(const RegionHeader& header, RegionKind kind,
                                     std::size_t real_bytes);

}  // namespace splinecast::ipc
