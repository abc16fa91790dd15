#pragma once

#include <cstdint>
#include <span>

#include "core/online/sliding_window.hpp"
#include "ipc/board/segment.hpp"
#include "ipc/layout/header.hpp"
#include "ipc/layout/summary.hpp"
#include "ipc/verification/run_restart.hpp"
#include "ipc/verification/sent_items.hpp"
#include "splinecast/boundary_condition.hpp"
#include "splinecast/dimension_kind.hpp"

namespace splinecast::ipc {

/// The record of a stream, or of a part of one: the items sent, how it was solved, and the
/// published segments.
///
/// A part begins in the middle of a stream. Its first segment is not solved again; it is only used
/// for the state in which the next one begins. The next segment either continues a run, with
/// `restart`, or it is an entry of a run whose waypoints are all known, from another run that had
/// waypoints.
struct StreamRecord {
  core::WindowOptions window;
  DimensionKinds kinds;
  const SentItems& items;
  std::span<const SegmentCopy> segments;  ///< consecutive settled segments, oldest first
  Summary summary;                        ///< the last summary
  Condition end;                          ///< the condition that finished the stream
  bool is_part = false;                   ///< it does not begin with segment 1
  const RunRestart* restart = nullptr;    ///< of a part: the knots before its second segment
  std::uint64_t rules = kRules;           ///< of stops and entries, by which it was solved
};

}  // namespace splinecast::ipc
