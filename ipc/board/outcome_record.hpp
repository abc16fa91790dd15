#pragma once

#include "ipc/memory/word.hpp"
#include "splinecast/status.hpp"
#include "splinecast/time.hpp"

namespace splinecast::ipc {

/// An outcome that differs from that of a waypoint on the spline at its own time.
struct OutcomeRecord {
  Word item = 0;       ///< the last one of a range
  OutcomeKind kind{};  ///< in_force, passed_over or withdrawn
  OutcomeWay way{};    ///< in_force
  Time time{};         ///< in_force
  Word first = 0;      ///< first item of the range; in_force: the item

  [[nodiscard]] bool is_of(Word i) const noexcept { return i >= first && i <= item; }
};

}  // namespace splinecast::ipc
