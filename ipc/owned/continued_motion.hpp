#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "ipc/board/reader.hpp"
#include "ipc/layout/header.hpp"
#include "ipc/ring/item.hpp"
#include "ipc/ring/reader.hpp"
#include "ipc/ring/writer.hpp"
#include "ipc/solve/shown_motion.hpp"
#include "splinecast/dimension_kind.hpp"
#include "splinecast/limits.hpp"
#include "splinecast/status.hpp"
#include "splinecast/waypoint.hpp"

namespace splinecast::ipc {

/// The motion in the ring of a live stream that a new producer continues, whose first waypoint may
/// be of another one. One thread uses it.
class ContinuedMotion {
 public:
  /// `ring` has items; `board` is the solver's, with this header; both outlive the object.
  /// Allocates.
  ContinuedMotion(const WaypointRingReader& ring, const KnotBoardReader& board,
                  const RegionHeader& header);

  /// Whether the waypoint continues the motion, on a curve that is settled until `settled`: it is
  /// later than the newest item, and the chord to it keeps the limits of velocity, and the change
  /// from the chord before it those of acceleration; without limits, those that the motion shows.
  /// A curve that has left its waypoints, or ends in a
  /// stop, leads to any waypoint by an entry. O(kSpan/kStep·(log n + D)).
  [[nodiscard]] bool continues(const Waypoint& waypoint, Time settled);

  /// Appends the first waypoint; or replaces the motion by it, if it does not continue it. Throws
  /// std::bad_alloc only, before it has changed anything.
  [[nodiscard]] AppendStatus append(const Waypoint& waypoint, WaypointRingWriter& writer,
                                    const WaypointRingWriter::Solved& known);

 private:
  [[nodiscard]] MotionLimits limits() const;
  [[nodiscard]] bool read(Word item) noexcept;
  [[nodiscard]] bool keeps(const MotionLimits& limits, Time interval, Time before);

  const WaypointRingReader* ring_;
  const KnotBoardReader* board_;
  DimensionKinds kinds_;
  Time stop_length_;
  MotionLimits given_;
  ShownMotion shown_;
  RingItem item_;                        ///< scratch
  std::vector<double> position_;         ///< of the waypoint, as its representative
  std::vector<double> last_;             ///< of the newest item
  std::vector<double> velocity_before_;  ///< of the chord before it
  std::vector<double> coefficients_;     ///< scratch
};

/// Replaces the motion in a ring by one waypoint, as soon as possible. `past` if that is too late.
[[nodiscard]] AppendStatus replace_motion(const Waypoint& waypoint, WaypointRingWriter& writer,
                                          const WaypointRingWriter::Solved& known) noexcept;

}  // namespace splinecast::ipc
