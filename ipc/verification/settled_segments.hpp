#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "ipc/board/reader.hpp"
#include "ipc/board/segment.hpp"
#include "ipc/layout/summary.hpp"

namespace splinecast::ipc {

/// A segment that has settled up to a time before its end; a revision may still cut it after that.
struct OpenSegment {
  Time until{};
  SegmentCopy segment;
};

/// Collects the settled segments of a stream while it runs. Only reads its board.
///
/// Misses none if look() is called before the board has lost a settled segment. A missed segment
/// shows as a gap between a segment's `next` and the number of the segment after it. Keeps them
/// until they are dropped: about (order + 2)·D doubles each. One thread uses it.
class SettledSegments {
 public:
  /// Each look reads `board`, which outlives this. `is_held_before_start`: the stream is live, so
  /// its curve rests before the first waypoint.
  explicit SettledSegments(const KnotBoardReader& board, bool is_held_before_start = false);

  /// Takes the segments that have settled since the last look; all if the stream is finished. O(D)
  /// per segment. Allocates; never stores to shared memory. Two loads if nothing has settled since.
  ///
  /// `final_until`: of a stream that follows a time law what LawFollower::final_until() returned
  /// before this call: no segment is taken that ends after it.
  void look(Time final_until = Time::max());

  /// The segments, oldest first, with waypoint and acceleration step. The step is empty after a
  /// gap.
  [[nodiscard]] std::span<const SegmentCopy> segments() const noexcept { return segments_; }

  /// Drops the segments that have been collected. The next look continues after them.
  void drop() noexcept { segments_.clear(); }

  /// Number of the segment that will be collected next: that at the end of the last one, 1 before
  /// the first one.
  [[nodiscard]] Word next() const noexcept { return next_; }

  /// Whether the last look left settled segments because of `final_until`.
  [[nodiscard]] bool waits() const noexcept { return waits_; }

  /// The next segment, if a part of it has settled, but not its end. Has no acceleration step.
  /// Allocates.
  [[nodiscard]] std::optional<OpenSegment> open() const;

  /// The summary of the board at the last look.
  [[nodiscard]] const Summary& summary() const noexcept { return summary_; }

 private:
  [[nodiscard]] bool take(const Look& look, Time final_until);
  void keep();
  [[nodiscard]] const BoardSegment& copy() const noexcept { return copies_[last_]; }

  const KnotBoardReader* board_;
  bool is_held_before_start_;
  Summary summary_;
  Look seen_;  ///< of the last look that was complete
  /// The last two segments that were copied; they share a knot. The newest one is at last_.
  std::array<BoardSegment, 2> copies_;
  std::size_t last_ = 0;
  std::vector<double> start_;    ///< scratch
  std::vector<double> end_;      ///< scratch
  std::vector<double> arrival_;  ///< acceleration at the end of the segment kept last
  std::vector<SegmentCopy> segments_;
  Word next_ = 1;
  bool waits_ = false;
  bool is_open_ = false;  ///< copy() is the next segment, which has not settled to its end
  Time until_{};          ///< then the time up to which it has
};

}  // namespace splinecast::ipc
