#include "splinecast/snapshot.hpp"

#include "ipc/sampling/snapshot.hpp"

namespace splinecast {

Snapshot::Snapshot(std::size_t dimensions)
    : board_(std::make_unique<ipc::BoardSnapshot>(dimensions)) {}
Snapshot::Snapshot(Snapshot&&) noexcept = default;
Snapshot& Snapshot::operator=(Snapshot&&) noexcept = default;
Snapshot::~Snapshot() = default;

std::size_t Snapshot::dimensions() const noexcept { return board_->dimensions(); }

std::size_t Snapshot::size() const noexcept { return board_->segments().size(); }

SnapshotSegment Snapshot::operator[](std::size_t i) const noexcept {
  const ipc::SegmentCopy& copy = board_->segments()[i];
  return {.left = copy.left,
          .right = copy.right,
          .order = copy.order,
          .kind = copy.kind,
          .coefficients = copy.coefficients,
          .waypoint = copy.waypoint,
          .acceleration_step = copy.acceleration_step,
          .is_corner = copy.is_corner};
}

std::uint64_t Snapshot::revision() const noexcept { return board_->summary().revision; }

Time Snapshot::settled_until() const noexcept { return board_->summary().settled_until; }

}  // namespace splinecast
