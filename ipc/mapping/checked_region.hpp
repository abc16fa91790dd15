#pragma once

#include <string_view>

#include "ipc/layout/header.hpp"
#include "ipc/layout/knot_slots.hpp"
#include "ipc/layout/waypoint_items.hpp"
#include "ipc/mapping/region.hpp"
#include "ipc/memory/names.hpp"
#include "splinecast/options.hpp"

namespace splinecast::ipc {

/// A region that stands, mapped, with a copy of its header that has been checked against this
/// layout and the file's real size. Only the copy is to be used: the region's own may change.
template <typename Layout>
struct CheckedRegion {
  Region region;
  RegionHeader header{};
  Layout layout;
};

/// Maps a stream's waypoint ring or its knot board; `writable` for its owner only. Populates its
/// pages. Throws NoSuchStream if there is none; BadRegion, naming the file and the offending value,
/// if it is not to be trusted or not such a region.
[[nodiscard]] CheckedRegion<RingLayout> open_ring(std::string_view stream, bool writable,
                                                  const Trust& trust);
[[nodiscard]] CheckedRegion<BoardLayout> open_board(std::string_view stream, bool writable,
                                                    const Trust& trust);

/// Enters this process as the region's owner and counts its epoch up. Relaxed, like copy_header:
/// the three words are for people, and a copy made meanwhile may hold some of the owner before.
void enter_owner(std::span<std::byte> region, const RegionHeader& before) noexcept;

}  // namespace splinecast::ipc
