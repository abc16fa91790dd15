#pragma once

#include <span>

#include "core/online/sliding_window.hpp"
#include "ipc/board/segment.hpp"
#include "ipc/layout/summary.hpp"
#include "ipc/verification/sent_items.hpp"
#include "splinecast/boundary_condition.hpp"
#include "splinecast/dimension_kind.hpp"

namespace splinecast::ipc {

/// The record of a stream: the items sent, how it was solved, and the published segments.
struct StreamRecord {
  core::WindowOptions window;
  DimensionKinds kinds;
  const SentItems& items;
  std::span<const SegmentCopy> segments;  ///< the settled segments, from number 1 on
  Summary summary;                        ///< the last summary
  Condition end;                          ///< the condition that finished the stream
};

}  // namespace splinecast::ipc
