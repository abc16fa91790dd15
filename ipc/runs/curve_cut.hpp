#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/forms/entry.hpp"
#include "ipc/board/reader.hpp"
#include "ipc/board/segment.hpp"
#include "ipc/board/writer.hpp"
#include "ipc/layout/summary.hpp"
#include "ipc/runs/run_edges.hpp"
#include "splinecast/dimension_kind.hpp"
#include "splinecast/limits.hpp"
#include "splinecast/state.hpp"

namespace splinecast::ipc {

/// Cuts the committed curve at a time, so that another curve can continue from there. `find`
/// changes scratch memory only; `write` then changes the board. The cut segment keeps both its
/// knots, and no segment begins at its right knot any more.
///
/// Allocates only when constructed; one thread uses it.
class CurveCut {
 public:
  /// `board` and `published` are the two sides of one board; both outlive the cut.
  CurveCut(KnotBoardWriter& board, const KnotBoardReader& published, DimensionKinds kinds,
           MotionLimits limits);

  /// Finds the cut at t through the curve of a committed summary, which has a segment there. An
  /// acceleration beyond its limit becomes the limit. Returns false if the board holds data that no
  /// solver wrote.
  [[nodiscard]] bool find(const Summary& summary, Time t) noexcept;

  /// Lets the new curve begin at rest at the cut that was found.
  void come_to_rest() noexcept { ipc::come_to_rest(state_); }

  /// The state at the cut that was found, and the number of the knot that begins the new curve.
  [[nodiscard]] Instant state() const noexcept;
  [[nodiscard]] Word next() const noexcept { return next_; }

  /// Writes the changes of the cut that was found to the segment before it, and the hold before the
  /// cut if there is one.
  void write() noexcept;

  /// Writes a new knot at rest that is not a waypoint.
  void write_rest(Word number, core::SegmentForm form, Time time, std::span<const double> position,
                  Time begins = {}) noexcept;

 private:
  [[nodiscard]] bool read(Word number) noexcept;
  [[nodiscard]] std::span<const double> position_at(Time t) noexcept;

  KnotBoardWriter* board_;
  const KnotBoardReader* published_;
  DimensionKinds kinds_;
  MotionLimits limits_;
  Summary summary_;
  BoardSegment segment_;  ///< the one that is cut, or the one before the cut
  State state_;
  Time time_{};
  Word cut_ = 0;          ///< segment before the cut; 0: none
  Word next_ = 0;         ///< number of the knot that begins the new curve
  bool ends_ = false;     ///< the cut is not before the end of the curve: segment cut_ is unchanged
  bool is_held_ = false;  ///< the cut is after the end of the curve: a hold fills the time between
  /// Knot cut_ + 1 remains as the right knot of segment cut_; no segment begins there any more.
  bool keeps_right_ = false;
  std::vector<double> position_;  ///< scratch
};

/// The last segment of a committed summary whose left end is at or before t, or the first segment
/// if there is none. Uses the packed times: exact for the writer, a hint for other processes.
[[nodiscard]] Word segment_at(const KnotBoardReader& board, const Summary& summary,
                              Time t) noexcept;

}  // namespace splinecast::ipc
