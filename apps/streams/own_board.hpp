#pragma once

#include <cstdint>
#include <string>

#include "ipc/board/reader.hpp"
#include "ipc/layout/header.hpp"
#include "ipc/layout/knot_slots.hpp"
#include "ipc/layout/summary.hpp"
#include "ipc/mapping/checked_region.hpp"

namespace splinecast::apps {

/// The board of the stream that this process produces, read as by any passive reader.
class OwnBoard {
 public:
  /// Opens the board of the stream with this id. Throws NoSuchStream, BadRegion, or Failure if
  /// another stream has this name.
  OwnBoard(const std::string& stream, std::uint64_t stream_id, const Trust& trust);

  [[nodiscard]] const ipc::RegionHeader& header() const noexcept { return board_.header; }
  /// The newest summary; that of revision 0 if nothing is published yet. Throws Failure if it
  /// cannot be read.
  [[nodiscard]] ipc::Summary summary() const;
  [[nodiscard]] const ipc::KnotBoardReader& reader() const noexcept { return reader_; }

 private:
  ipc::CheckedRegion<ipc::BoardLayout> board_;
  ipc::KnotBoardReader reader_;
};

/// Removes the board that an embedded solver of this process made for a ring that has been removed.
/// Does nothing if there is a ring, or if the board now belongs to another process.
void remove_board_without_ring(const std::string& stream, const Trust& trust);

}  // namespace splinecast::apps
