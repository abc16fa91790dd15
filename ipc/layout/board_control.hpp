#pragma once

#include <cstddef>
#include <tuple>

#include "ipc/layout/summary.hpp"
#include "ipc/layout/table.hpp"
#include "ipc/memory/separation.hpp"

namespace splinecast::ipc {

inline constexpr std::size_t kChangesKept = 64;
inline constexpr std::size_t kStepBuckets = 40;

/// The control block of a spline region.
inline constexpr std::tuple kBoardControlRows{
    FieldRow{"revision",
             {.words = 1},
             FieldWriter::owner,
             "number of the newest committed revision: the commit word; readers sleep on it"},
    FieldRow{"retired", {.words = 1}, FieldWriter::owner, "not 0: the region is no longer in use"},
    FieldRow{"settled until",
             {.words = 1},
             FieldWriter::owner,
             "ns: no later revision changes the curve before this time"},
    FieldRow{"holders",
             {.words = 1},
             FieldWriter::owner,
             "number of stoppers that hold the stream, for the producer"},
    padding(kSeparationWords - 4),
    FieldRow{
        "consumed", {.words = 1}, FieldWriter::owner, "number of items consumed, for the producer"},
    FieldRow{"late",
             {.words = 1},
             FieldWriter::owner,
             "of a live stream: the last revision that was committed too late"},
    FieldRow{"checked",
             {.words = 1},
             FieldWriter::owner,
             "of a live stream: the last revision whose commit was compared with the clock"},
    FieldRow{"outcomes lost",
             {.words = 1},
             FieldWriter::owner,
             "items below this number may have had an outcome of which the record is lost"},
    padding(kSeparationWords - 4),
    FieldRow{"sleeping", {.words = 1}, FieldWriter::owner, "1: the solver sleeps on `written`"},
    padding(kSeparationWords - 1),
    FieldRow{"summary, cell 0", {.words = kSummaryWords}, FieldWriter::owner, "see the next part"},
    FieldRow{"summary, cell 1", {.words = kSummaryWords}, FieldWriter::owner, "see the next part"},
    FieldRow{"changed from",
             {.words = kChangesKept},
             FieldWriter::owner,
             "ns: revision r changed the curve from the time in word r mod 64 on"},
    FieldRow{"step times",
             {.words = kStepBuckets},
             FieldWriter::owner,
             "word i: number of solver steps that took 2ⁱ to 2ⁱ⁺¹ ns; the last word: or longer"}};
inline constexpr auto kBoardControlFields = place(kBoardControlRows);
inline constexpr std::size_t kBoardControlWords = size_of(kBoardControlFields).words;
inline constexpr std::size_t kRevision = word_of(kBoardControlFields, "revision");
inline constexpr std::size_t kSettledUntil = word_of(kBoardControlFields, "settled until");
inline constexpr std::size_t kHolders = word_of(kBoardControlFields, "holders");
inline constexpr std::size_t kConsumed = word_of(kBoardControlFields, "consumed");
inline constexpr std::size_t kLate = word_of(kBoardControlFields, "late");
inline constexpr std::size_t kChecked = word_of(kBoardControlFields, "checked");
inline constexpr std::size_t kOutcomesLost = word_of(kBoardControlFields, "outcomes lost");
inline constexpr std::size_t kSleeping = word_of(kBoardControlFields, "sleeping");
inline constexpr std::size_t kSummarySlot = word_of(kBoardControlFields, "summary, cell 0");
inline constexpr std::size_t kChanges = word_of(kBoardControlFields, "changed from");
inline constexpr std::size_t kStepTimes = word_of(kBoardControlFields, "step times");

}  // namespace splinecast::ipc
