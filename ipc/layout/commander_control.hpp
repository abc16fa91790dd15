#pragma once

#include <cstddef>
#include <tuple>

#include "ipc/layout/areas.hpp"
#include "ipc/layout/separation.hpp"
#include "ipc/layout/table.hpp"

namespace splinecast::ipc {

/// The control block of a commander region, one cache line: the commander's latest state. See
/// ipc/law/commander_record.hpp for the order of loads and stores.
inline constexpr std::tuple kCommanderControlRows{
    FieldRow{"sequence",
             {.words = 1},
             FieldWriter::owner,
             "odd while the words after `retired` are written; the solver of the law sleeps on it"},
    FieldRow{"retired", {.words = 1}, FieldWriter::owner, "not 0: the region is no longer in use"},
    FieldRow{"number",
             {.words = 1},
             FieldWriter::owner,
             "number of requests made so far, renewals not counted; 0: none yet"},
    FieldRow{"time",
             {.words = 1},
             FieldWriter::owner,
             "ns by CLOCK_MONOTONIC: when the request was made or last renewed"},
    FieldRow{"rate",
             {.words = 1},
             FieldWriter::owner,
             "double: requested rate, at least 0; −1: released"},
    FieldRow{"ramp", {.words = 1}, FieldWriter::owner, "ns: length of the ramp to it"},
    FieldRow{"dead man",
             {.words = 1},
             FieldWriter::owner,
             "ns: the law holds if the request is not renewed for this long; 0: never"},
    FieldRow{"dead-man ramp", {.words = 1}, FieldWriter::owner, "ns: length of the ramp to that"},
    padding(kLineWords - 8)};
inline constexpr auto kCommanderControlFields = place(kCommanderControlRows);
inline constexpr std::size_t kCommanderControlWords = size_of(kCommanderControlFields).words;
inline constexpr std::size_t kCommanderSequence = word_of(kCommanderControlFields, "sequence");
inline constexpr std::size_t kCommanderNumber = word_of(kCommanderControlFields, "number");

/// Number of words of a commander's record, from kCommanderNumber on.
inline constexpr std::size_t kCommanderRecordWords = 6;

/// Offsets of a commander region in bytes: it has no body.
struct CommanderLayout {
  std::size_t control;
  std::size_t bytes = kBodyOffset;
};

}  // namespace splinecast::ipc
