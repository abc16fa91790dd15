#pragma once

#include <cstddef>
#include <tuple>

#include "ipc/layout/separation.hpp"
#include "ipc/layout/summary.hpp"
#include "ipc/layout/table.hpp"

namespace splinecast::ipc {

inline constexpr std::size_t kChangesKept = 64;
inline constexpr std::size_t kStepBuckets = 40;

/// The control block of a spline region.
inline constexpr std::tuple kBoardControlRows{
    FieldRow{
        "revision", {.words = 1}, FieldWriter::owner, "the commit word, and what readers wait on"},
    FieldRow{"retired", {.words = 1}, FieldWriter::owner, "not 0 once the region is of no use"},
    FieldRow{"settled until",
             {.words = 1},
             FieldWriter::owner,
             "ns: no revision after the one at which it was stored changes anything before"},
    padding(kLineWords - 3),
    FieldRow{
        "consumed", {.words = 1}, FieldWriter::owner, "items consumed, a copy for the producer"},
    FieldRow{"late",
             {.words = 1},
             FieldWriter::owner,
             "the last revision that was committed too late, on a live stream"},
    FieldRow{"checked",
             {.words = 1},
             FieldWriter::owner,
             "the last revision whose commit was compared with the clock, on a live stream"},
    padding(kLineWords - 3),
    FieldRow{"sleeping", {.words = 1}, FieldWriter::owner, "the solver waits on `written`"},
    padding(kLineWords - 1),
    FieldRow{"summary, cell 0", {.words = kSummaryWords}, FieldWriter::owner, "see below"},
    FieldRow{"summary, cell 1", {.words = kSummaryWords}, FieldWriter::owner, "see below"},
    FieldRow{"changed from",
             {.words = kChangesKept},
             FieldWriter::owner,
             "ns: earliest time whose curve revision r changed, at r mod 64"},
    FieldRow{"step times",
             {.words = kStepBuckets},
             FieldWriter::owner,
             "how many of the solver's steps took 2ⁱ to 2ⁱ⁺¹ ns, at i; the last one counts all "
             "that took longer"}};
inline constexpr auto kBoardControlFields = place(kBoardControlRows);
inline constexpr std::size_t kBoardControlWords = size_of(kBoardControlFields).words;
inline constexpr std::size_t kRevision = word_of(kBoardControlFields, "revision");
inline constexpr std::size_t kSettledUntil = word_of(kBoardControlFields, "settled until");
inline constexpr std::size_t kConsumed = word_of(kBoardControlFields, "consumed");
inline constexpr std::size_t kLate = word_of(kBoardControlFields, "late");
inline constexpr std::size_t kChecked = word_of(kBoardControlFields, "checked");
inline constexpr std::size_t kSleeping = word_of(kBoardControlFields, "sleeping");
inline constexpr std::size_t kSummarySlot = word_of(kBoardControlFields, "summary, cell 0");
inline constexpr std::size_t kChanges = word_of(kBoardControlFields, "changed from");
inline constexpr std::size_t kStepTimes = word_of(kBoardControlFields, "step times");

}  // namespace splinecast::ipc
