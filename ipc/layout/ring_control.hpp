#pragma once

#include <cstddef>
#include <tuple>

#include "ipc/layout/separation.hpp"
#include "ipc/layout/table.hpp"

namespace splinecast::ipc {

/// The control block of a waypoints region.
inline constexpr std::size_t kProducerRefusals = 16;
inline constexpr std::tuple kRingControlRows{
    FieldRow{"written", {.words = 1}, FieldWriter::owner, "items appended"},
    FieldRow{"retired", {.words = 1}, FieldWriter::owner, "not 0 once the region is of no use"},
    FieldRow{"claimed",
             {.words = 1},
             FieldWriter::owner,
             "how far the last replacement writes, stored before its items"},
    padding(kLineWords - 3),
    FieldRow{"refused",
             {.words = kProducerRefusals},
             FieldWriter::owner,
             "items refused by the producer, a word per reason"}};
inline constexpr auto kRingControlFields = place(kRingControlRows);
inline constexpr std::size_t kRingControlWords = size_of(kRingControlFields).words;
inline constexpr std::size_t kWritten = word_of(kRingControlFields, "written");
inline constexpr std::size_t kClaimed = word_of(kRingControlFields, "claimed");
inline constexpr std::size_t kProducerCounters = word_of(kRingControlFields, "refused");

}  // namespace splinecast::ipc
