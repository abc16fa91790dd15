#pragma once

#include <span>
#include <vector>

#include "ipc/board/reader.hpp"
#include "ipc/board/segment.hpp"
#include "ipc/layout/summary.hpp"

namespace splinecast::ipc {

/// The settled segments of a stream, collected while it goes on: a passive reader of its board.
///
/// Whoever looks again before the board has lost a settled segment misses none; one that is missed
/// shows as a gap between a segment's `next` and the number of the one behind it. Keeps all of
/// them: some (order + 2)·D doubles each. One thread uses it.
class SettledSegments {
 public:
  /// `board` is read at every look and outlives this. `is_held_before_start`: the stream is live,
  /// so that it rests before its first waypoint.
  explicit SettledSegments(const KnotBoardReader& board, bool is_held_before_start = false);

  /// Takes what has settled since the last look, of a finished stream all: O(D) per segment.
  /// Allocates; stores to shared memory never. Where nothing has settled since it is two loads.
  void look();

  /// Oldest first, with waypoint and acceleration step, which is empty behind a gap.
  [[nodiscard]] std::span<const SegmentCopy> segments() const noexcept { return segments_; }

  /// The head under which the last look saw the board.
  [[nodiscard]] const Head& head() const noexcept { return head_; }

 private:
  [[nodiscard]] bool take(const Look& look);
  void keep();

  const KnotBoardReader* board_;
  bool is_held_before_start_;
  Head head_;
  Look seen_;  ///< of the last look that was complete
  BoardSegment copy_;
  std::vector<double> start_;    ///< scratch
  std::vector<double> end_;      ///< scratch
  std::vector<double> arrival_;  ///< acceleration at the end of the segment kept last
  std::vector<SegmentCopy> segments_;
};

}  // namespace splinecast::ipc
