#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include "ipc/board/reader.hpp"
#include "ipc/board/segment.hpp"
#include "ipc/layout/summary.hpp"
#include "ipc/memory/word.hpp"
#include "splinecast/dimension_kind.hpp"

namespace splinecast::ipc {

/// The source of the segments of a snapshot, and scratch memory.
struct SnapshotSource {
  const KnotBoardReader& board;
  const Summary& summary;       ///< summary of the revision
  const DimensionKinds& kinds;  ///< of the board's dimensions
  bool is_live;
  BoardSegment& copy;                    ///< scratch
  std::span<double> start_acceleration;  ///< scratch
  std::span<double> end_acceleration;    ///< scratch
};

/// Several segments of one revision: a consistent piece of the curve, whole or not at all.
class BoardSnapshot {
 public:
  /// Allocates as it grows; a reused one stops allocating.
  explicit BoardSnapshot(std::size_t dimensions) : dimensions_(dimensions) {}

  [[nodiscard]] std::size_t dimensions() const noexcept { return dimensions_; }
  [[nodiscard]] const Summary& summary() const noexcept { return summary_; }

  /// Lowers the settled time to `t`, unless the stream is finished: of a stream that follows a law,
  /// to what LawFollower::final_until() returned before the segments were copied.
  void settle_at_most(Time t) noexcept {
    if (!summary_.finished) summary_.settled_until = std::min(summary_.settled_until, t);
  }
  /// Whether the curve has settled at `t`.
  [[nodiscard]] bool has_settled(Time t) const noexcept {
    return summary_.finished || t < summary_.settled_until;
  }

  /// The segments, oldest first.
  [[nodiscard]] std::span<const SegmentCopy> segments() const noexcept {
    return std::span(segments_).first(size_);
  }

 private:
  friend class Sampler;
  [[nodiscard]] bool copy_segments(const SnapshotSource& source, Word oldest, Word newest);

  std::size_t dimensions_;
  Summary summary_;
  std::size_t size_ = 0;
  std::vector<SegmentCopy> segments_;
};

}  // namespace splinecast::ipc
