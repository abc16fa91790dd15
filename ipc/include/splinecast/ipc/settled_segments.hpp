#pragma once

#include <span>
#include <vector>

#include "splinecast/ipc/segment_board.hpp"

namespace splinecast::ipc {

/// The settled segments of a stream, collected while it goes on: a passive reader of its board.
///
/// Whoever looks again before the board has lost a settled segment misses none; one that is missed
/// shows as a gap between the numbers. Keeps all of them: some (order + 2)·D doubles each. One
/// thread uses it.
class SettledSegments {
 public:
  /// `board` is read at every look and outlives this.
  explicit SettledSegments(const SegmentBoardReader& board);

  /// Takes what has settled since the last look, of a finished stream all: O(D) per segment.
  /// Allocates; stores to shared memory never. Where nothing was published since it is one load.
  void look();

  /// Oldest first, with acceleration step and waypoint.
  [[nodiscard]] std::span<const SegmentCopy> segments() const noexcept { return segments_; }

  /// The head under which the last look saw the board.
  [[nodiscard]] const Head& head() const noexcept { return head_; }

 private:
  [[nodiscard]] bool take(Word r);

  const SegmentBoardReader* board_;
  Head head_;
  Word seen_ = 0;  ///< revision of the last look that was complete
  SegmentCopy copy_;
  std::vector<SegmentCopy> segments_;
};

}  // namespace splinecast::ipc
