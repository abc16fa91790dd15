#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "ipc/layout/header.hpp"
#include "ipc/owned/old_end.hpp"
#include "ipc/owned/ring.hpp"
#include "ipc/ring/path.hpp"
#include "ipc/ring/writer.hpp"
#include "splinecast/limits.hpp"
#include "splinecast/options.hpp"
#include "splinecast/producer.hpp"
#include "splinecast/state.hpp"
#include "splinecast/status.hpp"
#include "splinecast/waypoint.hpp"

namespace splinecast::ipc {

/// How the curve of a ring starts: what is written before its first waypoint, so that no controller
/// that held the end of an earlier stream is moved in a step. One thread uses it.
class StreamStart {
 public:
  using Solved = WaypointRingWriter::Solved;

  /// Finds the old end, if the ring has not begun. System calls. Throws std::bad_alloc only.
  StreamStart(const std::string& stream, const OwnedRing& ring, const ProducerOptions& options);

  /// Whether the first waypoint or start state is to be compared with an old end: only then call
  /// the other functions, except start_from().
  [[nodiscard]] bool is_open() const noexcept { return old_.has_value(); }

  /// Appends the first waypoint, or replaces from t, if the curve can start with it. `board`: the
  /// header of the solver's board, null until a solver has attached.
  [[nodiscard]] AppendStatus append(const Waypoint& waypoint, WaypointRingWriter& writer,
                                    const Solved& known, const RegionHeader* board) noexcept;
  [[nodiscard]] AppendStatus replace_from(Time t, const ReplacementPath& waypoints, Time blend,
                                          WaypointRingWriter& writer, const Solved& known,
                                          const RegionHeader* board) noexcept;

  /// Appends a start state; see Producer::start_from.
  [[nodiscard]] AppendStatus start_from(const Instant& state, const StartOptions& how,
                                        WaypointRingWriter& writer, const Solved& known) noexcept;

  /// The state at rest at the old end from which the stream can start, as of the last look at it.
  [[nodiscard]] Instant state(const Solved& known) const noexcept;

  /// Reads the old end again. Returns whether it is known now. May allocate.
  [[nodiscard]] bool look() noexcept { return old_->look() == OldEnd::Known::yes; }

  /// Why a first waypoint is elsewhere; "" without D values. Throws std::bad_alloc only.
  [[nodiscard]] std::string why_elsewhere(const Waypoint& first, const Solved& known,
                                          const RegionHeader* board);

 private:
  [[nodiscard]] MotionLimits limits(const RegionHeader* board) const;
  [[nodiscard]] AppendStatus begin(const Waypoint& first, std::optional<Time> replaced_from,
                                   WaypointRingWriter& writer, const Solved& known,
                                   const RegionHeader* board) noexcept;
  [[nodiscard]] AppendStatus started(AppendStatus status) noexcept;

  std::vector<double> zeros_;
  double max_rate_;
  Time longest_interval_;
  std::optional<OldEnd> old_;  ///< until the stream has started
};

}  // namespace splinecast::ipc
