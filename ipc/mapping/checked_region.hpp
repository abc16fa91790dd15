#pragma once

#include <string_view>

#include "ipc/layout/header.hpp"
#include "ipc/layout/knot_slots.hpp"
#include "ipc/layout/waypoint_items.hpp"
#include "ipc/mapping/region.hpp"
#include "ipc/memory/names.hpp"
#include "splinecast/options.hpp"

namespace splinecast::ipc {

/// A mapped region, with a copy of its header that has been checked against this layout and the
/// file's real size. Use only the copy: the header in the region may change.
template <typename Layout>
struct CheckedRegion {
  Region region;
  RegionHeader header{};
  Layout layout;
};

/// Maps a stream's waypoint ring or its knot board; `writable` for its owner only. Populates its
/// pages. Throws NoSuchStream if there is none; BadRegion, naming the file and the offending value,
/// if it is not trusted or not such a region.
[[nodiscard]] CheckedRegion<RingLayout> open_ring(std::string_view stream, bool writable,
                                                  const Trust& trust);
[[nodiscard]] CheckedRegion<BoardLayout> open_board(std::string_view stream, bool writable,
                                                    const Trust& trust);

/// Writes this process into the header as the region's owner and increments the epoch. Relaxed,
/// like copy_header: no other data depends on the three words, and a copy made meanwhile may mix
/// those of two owners.
void enter_owner(std::span<std::byte> region, const RegionHeader& before) noexcept;

}  // namespace splinecast::ipc
