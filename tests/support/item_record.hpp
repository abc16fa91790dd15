#pragma once

#include "splinecast/ipc/knot_board.hpp"
#include "splinecast/ipc/sent_items.hpp"
#include "splinecast/ipc/waypoint_ring.hpp"

namespace splinecast::testing {

/// What a ring was sent, item by item, and what its solver refused: all of it, if `note` is called
/// before the ring or the list of refusals is overwritten.
class ItemRecord {
 public:
  explicit ItemRecord(std::size_t dimensions) : items_(dimensions), scratch_(dimensions) {}

  /// Notes the items that have been appended since the last time.
  void note_items(const ipc::WaypointRingReader& ring) {
    while (items_.size() < ring.head()) {
      ring.copy(items_.size(), scratch_);
      const auto values = std::span<const double>(scratch_.values);
      const std::size_t n = items_.dimensions();
      items_.add(scratch_.kind,
                 {.time = scratch_.time,
                  .position = values.first(n),
                  .velocity = scratch_.has_velocity ? values.subspan(n, n) : values.first(0),
                  .acceleration = scratch_.has_acceleration ? values.last(n) : values.first(0)});
    }
  }

  /// Notes the first `refused` refusals of the stream, as far as they are not noted yet.
  void note_refusals(const ipc::KnotBoardReader& board, ipc::Word refused) {
    for (; refusals_ < refused; ++refusals_) items_.refuse(board.refusal(refusals_).item);
  }

  [[nodiscard]] const ipc::SentItems& items() const noexcept { return items_; }

 private:
  ipc::SentItems items_;
  ipc::RingItem scratch_;
  ipc::Word refusals_ = 0;
};

}  // namespace splinecast::testing
