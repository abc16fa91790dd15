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
/// newer knots were known when each knot was last solved, where each run was entered, what was
/// frozen at the finish) and compares every segment bit by bit: ends, order, kind, coefficients,
/// the waypoint at its left end. Terminates for any content of the record. Items of an unfinished
/// stream after the last segment need not be on the curve. O(segments·K·D), and for each run
/// O(items); up to 1001 times that if late cuts have to be found out.
///
/// What it does not compare: why an entry or an end was chosen, and whether entries keep the
/// limits.
///
/// A run that begins exactly at a knot overwrites the segment that began there, so that segment
/// cannot be solved again. The state at which such a run begins is taken from its entry.
///
/// Throws std::invalid_argument for window options out of range. Safe from any thread.
[[nodiscard]] Verification verify(const StreamRecord& record);

}  // namespace splinecast::ipc
