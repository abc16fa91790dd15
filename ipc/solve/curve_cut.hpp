#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/forms/splice.hpp"
#include "ipc/board/reader.hpp"
#include "ipc/board/segment.hpp"
#include "ipc/board/writer.hpp"
#include "ipc/layout/summary.hpp"
#include "ipc/solve/run_edges.hpp"
#include "splinecast/dimension_kind.hpp"
#include "splinecast/state.hpp"

namespace splinecast::ipc {

/// A cut through the committed curve at a time, so that another curve goes on from there: found
/// first, which changes nothing but scratch, then written. A segment that is cut keeps both its
/// knots, and no segment begins at the right one any more.
///
/// Allocates when made only; one thread uses it.
class CurveCut {
 public:
  /// Both are sides of one board, and outlive the cut.
  CurveCut(KnotBoardWriter& board, const KnotBoardReader& published, DimensionKinds kinds);

  /// Finds the cut at t through the curve of a committed head, which has a segment there. Returns
  /// false if what was read back from the board was nothing that a solver had written.
  [[nodiscard]] bool find(const Head& head, Time t) noexcept;

  /// What goes on from the cut that was found: the state there, and the number of the knot that
  /// begins the new curve.
  [[nodiscard]] Instant state() const noexcept;
  [[nodiscard]] Word next() const noexcept { return next_; }

  /// Writes what the cut that was found makes of the segment before it.
  void write() noexcept;

  /// Writes a new knot at rest at which no waypoint stands.
  void write_rest(Word number, core::SegmentForm form, Time time, std::span<const double> position,
                  Time begins = {}) noexcept;

 private:
  [[nodiscard]] bool read(Word number) noexcept;
  [[nodiscard]] std::span<const double> position_at(Time t) noexcept;

  KnotBoardWriter* board_;
  const KnotBoardReader* published_;
  DimensionKinds kinds_;
  Head head_;
  BoardSegment segment_;  ///< that is cut, or lies before the cut
  State state_;
  Time time_{};
  Word cut_ = 0;                  ///< segment before the cut; 0: nothing stands there
  Word next_ = 0;                 ///< number of the knot that goes on
  bool ends_ = false;             ///< that segment ends at its natural end
  bool is_held_ = false;          ///< a hold follows it
  bool keeps_right_ = false;      ///< it keeps its right knot, where no segment begins any more
  std::vector<double> position_;  ///< scratch
};

/// The last committed segment of a head whose left end is at or before t; else the first one. By
/// the packed times, which are the writer's own: for the writer only.
[[nodiscard]] Word segment_at(const KnotBoardReader& board, const Head& head, Time t) noexcept;

}  // namespace splinecast::ipc
