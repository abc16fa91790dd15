#pragma once

#include <cstddef>
#include <tuple>

#include "ipc/layout/header.hpp"
#include "ipc/layout/table.hpp"
#include "ipc/memory/separation.hpp"
#include "ipc/memory/word.hpp"

namespace splinecast::ipc {

/// The parts that every region has.
inline constexpr std::tuple kRegionRows{
    FieldRow{"header",
             {.words = 2 * kPage / sizeof(Word)},
             FieldWriter::maker,
             "see the part Header; the rest is 0"},
    FieldRow{"control area",
             {.words = 2 * kPage / sizeof(Word)},
             FieldWriter::owner,
             "contains the control block, at offset 8192 + 128 · (stream id mod 46),\n"
             "so that the blocks of many streams are spread over the cache sets"},
    FieldRow{"body",
             {},
             FieldWriter::owner,
             "ring items; or refusals, excesses, outcomes, stoppers, times and slots of a board,\n"
             "on the board of a time law also the tables of its commanders"}};
inline constexpr auto kRegionFields = place(kRegionRows);
inline constexpr std::size_t kHeaderBytes = word_of(kRegionFields, "control area") * sizeof(Word);
inline constexpr std::size_t kBodyOffset = word_of(kRegionFields, "body") * sizeof(Word);
static_assert(kHeaderWords * sizeof(Word) <= kHeaderBytes);

}  // namespace splinecast::ipc
