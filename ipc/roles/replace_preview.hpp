#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include "core/limits/check.hpp"
#include "core/motion/plan.hpp"
#include "core/motion/plan_search.hpp"
#include "core/online/sliding_window.hpp"
#include "ipc/board/reader.hpp"
#include "ipc/sampling/sampler.hpp"
#include "ipc/solve/shown_motion.hpp"
#include "ipc/solve/stream_solver.hpp"
#include "splinecast/producer.hpp"
#include "splinecast/status.hpp"
#include "splinecast/waypoint.hpp"

namespace splinecast::ipc {

/// Plans a replacement as the stream's solver would, from its board, without changing anything. A
/// solver may plan differently on a stream without limits, because it has seen more of the shown
/// motion than is on the board, and where the present curve exceeds a bound, because its entry may
/// go as far as that. Waypoints beyond a limit are neither refused nor left out.
///
/// Allocates when constructed, and in the result as it grows. One thread uses it.
class ReplacementPlanner {
 public:
  /// `board` outlives the planner; the other arguments are those of its solver; `live` is set for a
  /// live stream.
  ReplacementPlanner(const KnotBoardReader& board, const core::WindowOptions& options,
                     const DimensionKinds& kinds, const std::optional<LiveOptions>& live,
                     Beyond beyond);

  /// Plans the replacement of everything after out.begin by these waypoints, which the ring would
  /// accept; with out.from_rest it begins at rest there. O(n·K·D) and at most 170 candidates of an
  /// entry. Sets all other members except `status`.
  void plan(std::span<const Waypoint> waypoints, Time blend, ReplacePreview& out);

 private:
  [[nodiscard]] bool read_state(Time t);
  [[nodiscard]] bool search(bool is_last, ReplacePreview& out);
  [[nodiscard]] bool find_entry(std::span<const Waypoint> waypoints, ReplacePreview& out);
  void take_segments(std::size_t end, ReplacePreview& out);
  void take(const core::Segment& segment, MotionPeaks* entry, ReplacePreview& out) const;
  void take_stop(ReplacePreview& out);
  void take_entry(ReplacePreview& out);

  const KnotBoardReader* board_;
  Sampler sampler_;
  ShownMotion shown_;
  core::Plan plan_;
  core::PlanSearch search_;
  std::optional<std::size_t> next_segment_;  ///< the next segment of the target to add
  State state_;                              ///< scratch
  core::Segment segment_;                    ///< scratch
};

/// Where the newest run on a board begins, if the solver took the replacement of this item, and the
/// board still has that knot.
[[nodiscard]] std::optional<ReplacementBegin> begin_of_run(const KnotBoardReader& board, Word item);

}  // namespace splinecast::ipc
