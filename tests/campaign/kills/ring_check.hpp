#pragma once

#include "ipc/layout/header.hpp"
#include "ipc/mapping/region.hpp"
#include "ipc/ring/item.hpp"
#include "ipc/ring/reader.hpp"
#include "tests/campaign/kills/plan.hpp"

namespace splinecast::campaign {

/// A passive observer of a stream's waypoint ring, whom the producer does not wait for: an item
/// that it may keep is whole, and the one that was sent. One thread uses it.
class RingCheck {
 public:
  /// `plan` and `facts` outlive the check. Throws as ipc::Region::open does.
  RingCheck(const Plan& plan, ReaderFacts& facts);

  /// Looks at the item that was appended `back` items before the newest, if there is one.
  void look(ipc::Word back);

  /// Items appended so far, and whether the newest ends the stream.
  [[nodiscard]] ipc::Word appended() const noexcept { return ring_.head(); }
  [[nodiscard]] bool is_finished() const noexcept;

  [[nodiscard]] std::uint64_t stream_id() const noexcept { return header_.stream_id; }
  [[nodiscard]] std::size_t capacity() const noexcept { return ring_.capacity(); }

 private:
  const Plan* plan_;
  ReaderFacts* facts_;
  ipc::Region region_;
  ipc::RegionHeader header_;
  ipc::WaypointRingReader ring_;
  ipc::RingItem item_;
};

}  // namespace splinecast::campaign
