#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>

#include "core/online/sliding_window.hpp"
#include "ipc/board/segment.hpp"
#include "ipc/verification/sent_items.hpp"
#include "splinecast/boundary_condition.hpp"
#include "splinecast/dimension_kind.hpp"

namespace splinecast::ipc {

/// A stream as it went: what it was sent, how it was solved, and what came out.
struct StreamRecord {
  core::WindowOptions window;
  DimensionKinds kinds;
  const SentItems& items;
  std::span<const SegmentCopy> segments;  ///< settled ones from number 1
  Head head;                              ///< the last one
  Condition end;                          ///< that the stream was finished with
};

/// The first thing in which a stream is not what its items and decisions make it.
struct Difference {
  Word segment = 0;
  Time left{};         ///< its ends, as published
  Time right{};        ///<
  std::string what{};  ///< such as `coefficient 3 of dimension 0`
  std::string published{};
  std::string solved{};
};

struct Verification {
  std::size_t equal = 0;  ///< segments found equal, before the first difference
  std::optional<Difference> first{};
};

/// Solves a stream again from its items, with the decisions that its segments record (how many
/// newer knots each knot had seen when it was last solved, where each run was entered, what was
/// frozen at the finish) and compares every segment bit by bit: ends, order, kind, coefficients,
/// the waypoint at its left end. Whatever the record holds, it returns; of an unfinished stream
/// items behind the last segment are not missed. O(segments·K·D).
///
/// A run that begins on a knot replaces the segment behind it, of which nothing else is left: there
/// the state that it began with is taken from its splice.
///
/// Throws std::invalid_argument for window options out of range. Safe from any thread.
[[nodiscard]] Verification verify(const StreamRecord& record);

}  // namespace splinecast::ipc
