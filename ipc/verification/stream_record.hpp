#pragma once

#include <span>

#include "core/online/sliding_window.hpp"
#include "ipc/board/segment.hpp"
#include "ipc/layout/summary.hpp"
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

}  // namespace splinecast::ipc
