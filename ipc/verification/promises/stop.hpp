#pragma once

#include <string_view>

#include "core/forms/stop.hpp"
#include "core/polynomial/segment.hpp"
#include "ipc/board/segment.hpp"
#include "splinecast/state.hpp"
#include "splinecast/time.hpp"

/// What a record must show of a stop. By the rules 2 (see kRules) the solver decides how long a
/// stop takes and with which acceleration it begins; verification reads both from the record, and
/// checks what solvers promise. By the rules 1 it computes both. Nothing here allocates.
namespace splinecast::ipc {

/// The length of a stop by the rules 1: the stop time, or as long as the limits need. Bounds and
/// rotations do not count. O(D).
[[nodiscard]] Time former_stop_time(const core::StopRules& rules, const Instant& from) noexcept;

/// The length of a recorded stop, unless it was cut.
[[nodiscard]] inline Time recorded_length(const SegmentCopy& stop) noexcept {
  return stop.natural_right - stop.left;
}

/// Which part of a stop a segment is.
enum class StopPart {
  whole,      ///< all of it
  shortest,   ///< all of it, at the end of a curve: it may be shorter than the stop time
  remainder,  ///< what is left of it after an entry
};

/// Which promise a stop breaks; empty: none. `from` is where it begins, with the acceleration with
/// which it begins; `stop` is the segment built from that.
///
/// A stop keeps the limits of acceleration and jerk. A whole one takes the stop time, or as long as
/// the limits need, or is shorter so that it keeps the bounds of dimensions with a limit of
/// acceleration; then a longer one would not keep them. Of a record with quaternions only the
/// limits of its other dimensions are checked. O(D).
[[nodiscard]] std::string_view broken_promise(const core::StopRules& rules, const Instant& from,
                                              const core::Segment& stop, StopPart part) noexcept;

}  // namespace splinecast::ipc
