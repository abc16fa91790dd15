#pragma once

#include <cstddef>
#include <optional>

#include "ipc/verification/difference.hpp"
#include "ipc/verification/stream_record.hpp"

namespace splinecast::ipc {

struct Verification {
  std::size_t equal = 0;  ///< segments found equal, before the first difference
  std::optional<Difference> first{};
};

/// Solves a stream again from its items, with the decisions that its segments record (how many
/// newer knots each knot had seen when it was last solved, where each run was entered, what was
/// frozen at the finish) and compares every segment bit by bit: ends, order, kind, coefficients,
/// the waypoint at its left end. Returns for any content of the record; items of an unfinished
/// stream after the last segment need not be on the curve. O(segments·K·D).
///
/// A run that begins on a knot replaces the segment after that knot, of which nothing else is left:
/// the state at which the run begins is then taken from its entry.
///
/// Throws std::invalid_argument for window options out of range. Safe from any thread.
[[nodiscard]] Verification verify(const StreamRecord& record);

}  // namespace splinecast::ipc
