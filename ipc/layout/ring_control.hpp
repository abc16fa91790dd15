#pragma once

#include <cstddef>
#include <tuple>

#include "ipc/layout/table.hpp"
#include "ipc/memory/separation.hpp"

namespace splinecast::ipc {

inline constexpr std::size_t kProducerRefusals = 32;

/// The control block of a waypoints region.
inline constexpr std::tuple kRingControlRows{
    FieldRow{"written",
             {.words = 1},
             FieldWriter::owner,
             "number of items appended; the solver sleeps on it"},
    FieldRow{"retired", {.words = 1}, FieldWriter::owner, "not 0: the region is no longer in use"},
    FieldRow{"claimed",
             {.words = 1},
             FieldWriter::owner,
             "what `written` is after the last replacement; stored before its items are written"},
    padding(kSeparationWords - 3),
    FieldRow{"refused",
             {.words = kProducerRefusals},
             FieldWriter::owner,
             "word s: number of items that the producer refused with status s"}};
inline constexpr auto kRingControlFields = place(kRingControlRows);
inline constexpr std::size_t kRingControlWords = size_of(kRingControlFields).words;
inline constexpr std::size_t kWritten = word_of(kRingControlFields, "written");
inline constexpr std::size_t kClaimed = word_of(kRingControlFields, "claimed");
inline constexpr std::size_t kProducerCounters = word_of(kRingControlFields, "refused");

}  // namespace splinecast::ipc
