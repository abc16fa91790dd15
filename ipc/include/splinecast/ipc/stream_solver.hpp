#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "splinecast/core/dimension_kind.hpp"
#include "splinecast/core/sliding_window.hpp"
#include "splinecast/ipc/clock.hpp"
#include "splinecast/ipc/segment_board.hpp"
#include "splinecast/ipc/waypoint_ring.hpp"

namespace splinecast::ipc {

/// What one step of a solver did.
struct StepResult {
  Word consumed = 0;       ///< ring items taken
  bool published = false;  ///< whether a revision was committed
};

/// The solver without its regions: takes waypoints from a ring, solves the window, publishes
/// segments on a board. Without a thread or a clock of its own, so that simulated time, fuzzers
/// and ThreadSanitizer drive the code that runs for real. Allocates when made only; `step` never
/// blocks and makes no system call but the clock's.
class StreamSolver {
 public:
  /// `board` and `published` are the writing and the reading side of one board; with `ring` they
  /// outlive the solver. `kinds` are those of the ring's dimensions. Goes on where the board says
  /// that a solver before it stood. Throws std::invalid_argument for window options out of range or
  /// a board too small for them.
  StreamSolver(const WaypointRingReader& ring, SegmentBoardWriter& board,
               const SegmentBoardReader& published, const core::WindowOptions& window,
               const IngestLimits& limits, core::DimensionKinds kinds = {});

  /// Takes what the ring holds, up to a bounded batch, and publishes the result as one revision.
  /// O(batch·K·D).
  StepResult step(const Clock& clock) noexcept;

  /// The head last committed.
  [[nodiscard]] const Head& head() const noexcept { return head_; }

  /// The smallest board for a settle lag.
  [[nodiscard]] static std::size_t min_capacity(std::size_t settle) noexcept;

 private:
  void restore(const SegmentBoardReader& published);
  void take(RingItem& item, Word number) noexcept;
  void take_waypoint(RingItem& item, Word number) noexcept;
  void take_finish(const RingItem& item, Word number) noexcept;
  void refuse(Word number, Refusal reason) noexcept;
  void write_segment(std::size_t i) noexcept;
  void publish(const Clock& clock) noexcept;

  const WaypointRingReader* ring_;
  SegmentBoardWriter* board_;
  IngestLimits limits_;
  core::DimensionKinds kinds_;
  core::SlidingWindow window_;
  std::size_t max_batch_;
  Head head_;
  RingItem item_;
  core::Condition end_;
  core::Segment segment_;
  std::size_t settled_written_ = 0;  ///< leading segments that are on the board for good
};

}  // namespace splinecast::ipc
