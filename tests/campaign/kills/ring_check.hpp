#pragma once

#include "ipc/layout/header.hpp"
#include "ipc/mapping/region.hpp"
#include "ipc/ring/item.hpp"
#include "ipc/ring/reader.hpp"
#include "tests/campaign/kills/plan.hpp"

namespace splinecast::campaign {

/// A passive observer of a stream's waypoint ring: the producer does not wait for it. Checks that
/// an item that it may keep is not torn and equals the item that was sent. For one thread.
class RingCheck {
 public:
  /// `plan` and `facts` outlive the check. Throws the exceptions of ipc::Region::open().
  RingCheck(const Plan& plan, ReaderFacts& facts);

  /// Checks the item that was appended `back` items before the newest, if it exists.
  void look(ipc::Word back);

  /// Number of items appended so far.
  [[nodiscard]] ipc::Word appended() const noexcept { return ring_.written(); }
  /// Whether the newest item finishes the stream.
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
