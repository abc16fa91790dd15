#pragma once

#include "ipc/board/reader.hpp"
#include "ipc/memory/word.hpp"
#include "ipc/ring/reader.hpp"
#include "splinecast/status.hpp"

namespace splinecast::ipc {

/// What became of an item of `ring`, by the board of its solver. O(outcomes and refusals that the
/// board keeps); allocates nothing; no system call.
[[nodiscard]] ItemOutcome outcome_of(const KnotBoardReader& board, const WaypointRingReader& ring,
                                     Word item) noexcept;

}  // namespace splinecast::ipc
