#pragma once

#include <cstddef>
#include <tuple>

#include "ipc/layout/areas.hpp"
#include "ipc/layout/table.hpp"
#include "ipc/memory/separation.hpp"

namespace splinecast::ipc {

/// The control block of a commander region, one cache line: the commander's latest request. See
/// ipc/requests/record.hpp for the order of loads and stores.
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
    padding(kSeparationWords - 8)};
inline constexpr auto kCommanderControlFields = place(kCommanderControlRows);
inline constexpr std::size_t kCommanderControlWords = size_of(kCommanderControlFields).words;
inline constexpr std::size_t kCommanderSequence = word_of(kCommanderControlFields, "sequence");
inline constexpr std::size_t kCommanderNumber = word_of(kCommanderControlFields, "number");

/// Number of words of a commander's record, from kCommanderNumber on.
inline constexpr std::size_t kCommanderRecordWords = 6;

/// A commander in the table of its law, on the law's board.
inline constexpr std::size_t kCommanderNameBytes = 32;
inline constexpr std::tuple kCommanderRows{
    FieldRow{
        "id", {.words = 1}, FieldWriter::owner, "stream id of its region; 0: the slot is free"},
    FieldRow{"name",
             {.words = kCommanderNameBytes / sizeof(Word)},
             FieldWriter::owner,
             "the first 32 bytes of its name; the rest is 0"},
    FieldRow{"number",
             {.words = 1},
             FieldWriter::owner,
             "number of its request that is in force; 0: none yet"},
    FieldRow{"state",
             {.words = 1},
             FieldWriter::owner,
             "bit 0: it requests a rate\n"
             "bit 1: the dead man of that request has fired\n"
             "bit 2: its region holds no whole request any more"},
    FieldRow{"renewed",
             {.words = 1},
             FieldWriter::owner,
             "ns by CLOCK_MONOTONIC: its last request or renewal, when this row last changed"},
    FieldRow{"ramp", {.words = 1}, FieldWriter::owner, "ns: length of the ramp that it requests"},
    FieldRow{"bound begin",
             {.words = 1},
             FieldWriter::owner,
             "ns: when its bound begins; 0: it is constant since the law began"},
    FieldRow{"bound rate", {.words = 1}, FieldWriter::owner, "double: the bound there"},
    FieldRow{"bound slope", {.words = 1}, FieldWriter::owner, "double, 1/s: its slope there"},
    FieldRow{"bound ends", {.words = 2}, FieldWriter::owner, "ns: ends of its pieces; 0: none"},
    FieldRow{"end rates", {.words = 2}, FieldWriter::owner, "doubles: the bound there"}};
inline constexpr auto kCommanderFields = place(kCommanderRows);
inline constexpr std::size_t kCommanderWords = size_of(kCommanderFields).words;

/// Maximum number of commanders of a law, and the words of the table that has a row for each.
inline constexpr std::size_t kMostCommanders = 16;
inline constexpr std::size_t kCommanderTableWords = kMostCommanders * kCommanderWords;
static_assert(kCommanderWords == 16);

/// The control block of a stopper region, one cache line: the stopper's latest request. See
/// ipc/requests/record.hpp for the order of loads and stores.
inline constexpr std::tuple kStopperControlRows{
    FieldRow{"sequence",
             {.words = 1},
             FieldWriter::owner,
             "odd while the words after `retired` are written"},
    FieldRow{"retired", {.words = 1}, FieldWriter::owner, "not 0: the region is no longer in use"},
    FieldRow{
        "number", {.words = 1}, FieldWriter::owner, "number of requests made so far; 0: none yet"},
    FieldRow{"time", {.words = 1}, FieldWriter::owner, "ns by CLOCK_MONOTONIC: when it was made"},
    FieldRow{"latched",
             {.words = 1},
             FieldWriter::owner,
             "1: the stream is to stop, and to stay; 0: released. All else counts as 1"},
    padding(kSeparationWords - 5)};
inline constexpr auto kStopperControlFields = place(kStopperControlRows);
inline constexpr std::size_t kStopperControlWords = size_of(kStopperControlFields).words;
inline constexpr std::size_t kStopperSequence = word_of(kStopperControlFields, "sequence");
inline constexpr std::size_t kStopperNumber = word_of(kStopperControlFields, "number");

/// Number of words of a stopper's record, from kStopperNumber on.
inline constexpr std::size_t kStopperRecordWords = 3;

/// A stopper in the table of its stream, on the stream's board.
inline constexpr std::size_t kStopperNameBytes = kCommanderNameBytes;
inline constexpr std::tuple kStopperRows{
    FieldRow{
        "id", {.words = 1}, FieldWriter::owner, "stream id of its region; 0: the slot is free"},
    FieldRow{"name",
             {.words = kStopperNameBytes / sizeof(Word)},
             FieldWriter::owner,
             "the first 32 bytes of its name; the rest is 0"},
    FieldRow{"number",
             {.words = 1},
             FieldWriter::owner,
             "number of its request that is in force; 0: none yet"},
    FieldRow{"state",
             {.words = 1},
             FieldWriter::owner,
             "bit 0: it holds the stream\n"
             "bit 1: its region holds no whole request any more, which counts as that"},
    padding(1)};
inline constexpr auto kStopperFields = place(kStopperRows);
inline constexpr std::size_t kStopperWords = size_of(kStopperFields).words;

/// Maximum number of stoppers of a stream that its board names, and the words of the table that has
/// a row for each.
inline constexpr std::size_t kMostStoppers = 16;
inline constexpr std::size_t kStopperTableWords = kMostStoppers * kStopperWords;
static_assert(kStopperWords == 8);

/// Offsets of a request region, that of a commander or a stopper, in bytes: it has no body.
struct RequestLayout {
  std::size_t control;
  std::size_t bytes = kBodyOffset;
};

}  // namespace splinecast::ipc
