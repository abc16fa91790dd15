#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "core/limits/check.hpp"
#include "core/online/entry_search.hpp"
#include "core/online/sliding_window.hpp"
#include "ipc/board/knot_board.hpp"
#include "ipc/sampling/sampler.hpp"
#include "ipc/solve/shown_motion.hpp"
#include "ipc/solve/stream_solver.hpp"
#include "splinecast/status.hpp"
#include "splinecast/waypoint.hpp"

namespace splinecast::ipc {

/// Largest magnitudes along a motion, one value per dimension; of a quaternion those of its
/// components' derivatives.
struct MotionPeaks {
  std::vector<double> velocity;
  std::vector<double> acceleration;
  std::vector<double> jerk;
};

/// What a replacement would do to the curve.
struct ReplacePreview {
  AppendStatus status{};  ///< what `replace_from` would answer now; if not `accepted`, no more
  bool is_known = false;  ///< a curve stands whose state at t could be read; else no more
  core::Time begin{};     ///< of the motion: t, or what has settled if a stop is asked for later
  core::Time duration{};  ///< of the entry onto the waypoints; of a stop, until it rests
  bool enters = false;    ///< there is an entry; else the curve comes to rest from t on
  std::optional<std::size_t> waypoint{};  ///< at which it ends; none: it ends beyond the last one
  std::size_t passed_over = 0;            ///< waypoints that lie before its end
  MotionPeaks entry;                      ///< of the entry, or of the stop instead
  MotionPeaks motion;                     ///< of all from t until the curve rests
  core::Excess worst{};  ///< where that is nearest to a limit or farthest beyond; `u` counts from
                         ///< the segment's beginning. A ratio below 0: there are no limits
};

/// Plans a replacement as a stream's solver would, from what its board shows, without changing
/// anything. What the motion has shown is taken from the waypoints that are still on the board: a
/// solver that has seen more may plan otherwise on a stream without limits.
///
/// Allocates when made, and in the result as it grows. One thread uses it.
class ReplacementPlanner {
 public:
  /// `board` outlives the planner; the rest is what its solver has; `live` is set for a live
  /// stream.
  ReplacementPlanner(const KnotBoardReader& board, core::WindowOptions options,
                     core::DimensionKinds kinds, const std::optional<LiveOptions>& live);

  /// Plans the replacement of all behind t by these waypoints, which the ring would accept.
  /// O(n·K·D) and at most 170 candidates of an entry. Sets all but `status`.
  void plan(core::Time t, std::span<const core::Waypoint> waypoints, core::Time blend,
            ReplacePreview& out);

 private:
  [[nodiscard]] bool read_state(core::Time t);
  [[nodiscard]] bool find_entry(const core::Instant& from,
                                std::span<const core::Waypoint> waypoints, core::Time blend,
                                ReplacePreview& out);
  void take_segments(std::size_t end, ReplacePreview& out);
  void append(const core::Waypoint& waypoint);
  void take(const core::Segment& segment, MotionPeaks* entry, ReplacePreview& out) const;
  void take_stop(ReplacePreview& out, const core::Instant& from);
  void take_entry(ReplacePreview& out);

  const KnotBoardReader* board_;
  core::WindowOptions options_;
  core::DimensionKinds kinds_;
  core::Time min_splice_;
  bool is_live_;
  Sampler sampler_;
  ShownMotion shown_;
  core::SlidingWindow window_;
  core::EntrySearch search_;
  std::optional<std::size_t> next_segment_;  ///< of the target, to be taken next
  core::State state_;
  core::Segment segment_;
  std::vector<double> values_;  ///< of a waypoint: position, velocity, acceleration
};

}  // namespace splinecast::ipc
