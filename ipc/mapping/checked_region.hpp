#pragma once

#include <string>
#include <string_view>
#include <utility>

#include "ipc/layout/header.hpp"
#include "ipc/layout/knot_slots.hpp"
#include "ipc/layout/request_control.hpp"
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

/// A region of another process that stays mapped. `Reader` reads its layout, and refers to the
/// mapping: this may be moved.
template <typename Reader>
struct RegionView {
  Region region;
  RegionHeader header;
  Reader reader;

  /// Closes the descriptor of the file unless `keeps_descriptor`.
  template <typename Layout>
  explicit RegionView(CheckedRegion<Layout> opened, bool keeps_descriptor = false)
      : region(std::move(opened.region)),
        header(opened.header),
        reader(region.bytes(), opened.layout) {
    if (!keeps_descriptor) region.close_descriptor();
  }
};

/// Maps a stream's waypoint ring or its knot board, or the region of a commander or a stopper under
/// the result of commander_stream() or stopper_stream(), and populates its pages. `writable` is for
/// the owner only. Throws NoSuchStream if there is none; BadRegion, naming the file and the
/// offending value, if the region is not trusted or is not valid; StreamBusy if `writable` is set
/// and another process holds the lock on the region itself.
[[nodiscard]] CheckedRegion<RingLayout> open_ring(std::string_view stream, bool writable,
                                                  const Trust& trust);
[[nodiscard]] CheckedRegion<BoardLayout> open_board(std::string_view stream, bool writable,
                                                    const Trust& trust);
[[nodiscard]] CheckedRegion<RequestLayout> open_request(std::string_view stream, RegionKind kind,
                                                        bool writable, const Trust& trust);

/// Throws BadRegion if a live stream runs on the clock of another time namespace.
void require_same_clock(const RegionHeader& header, const std::string& stream);

/// Writes this process as the owner into the header: process id, time, and the epoch of `before`
/// plus 1. The epoch is stored last, with release. copy_header(), and a recorder, load it first,
/// with acquire: a process that finds an epoch finds the process id and the time of that owner or
/// of a later one. With relaxed, a recorder could write the process id of a dead owner beside the
/// epoch of its successor, though not on x86. The reverse remains possible: an epoch, and the
/// process id of the next owner, which has not stored its own epoch yet.
void enter_owner(std::span<std::byte> region, const RegionHeader& before) noexcept;

}  // namespace splinecast::ipc
