#pragma once

#include <cstddef>

#include "ipc/layout/areas.hpp"
#include "ipc/layout/board_control.hpp"
#include "ipc/layout/request_control.hpp"
#include "ipc/layout/ring_control.hpp"
#include "ipc/layout/table.hpp"
#include "ipc/memory/separation.hpp"
#include "ipc/memory/word.hpp"

namespace splinecast::ipc {

/// The word that marks a region as retired: at the same place in all control blocks.
inline constexpr std::size_t kRetired = word_of(kBoardControlFields, "retired");
static_assert(word_of(kRingControlFields, "retired") == kRetired);
static_assert(word_of(kCommanderControlFields, "retired") == kRetired);
static_assert(word_of(kStopperControlFields, "retired") == kRetired);
static_assert(kRevision == 0 && kWritten == 0 && kCommanderSequence == 0 &&
              kStopperSequence == 0);  // the words that processes wait on

/// Number of positions that the control block may have in the control area.
inline constexpr std::size_t kControlPositions =
    (kBodyOffset - kHeaderBytes - kBoardControlWords * sizeof(Word)) / kSeparation + 1;
static_assert(kRingControlWords <= kBoardControlWords);
static_assert(kCommanderControlWords <= kBoardControlWords);
static_assert(kStopperControlWords == kCommanderControlWords &&
              kStopperControlWords == kSeparationWords);

}  // namespace splinecast::ipc
