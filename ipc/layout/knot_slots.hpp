#pragma once

#include <cstddef>
#include <cstdint>
#include <tuple>

#include "ipc/layout/request_control.hpp"
#include "ipc/layout/table.hpp"
#include "splinecast/time.hpp"

namespace splinecast::ipc {

/// The parts of a knot's slot. Each exists twice and begins on a cache line.
inline constexpr std::tuple kCellRows{
    FieldRow{"tag",
             {.words = 1},
             FieldWriter::owner,
             "0: never written; all bits 1: retired; else\n"
             "bits 17–63: revision that wrote the cell\n"
             "bit 0: the node that belongs to it\n"
             "bits 1–4: form of the segment that begins here: 0 none, 1 cubic,\n"
             "2 to 4 cubic with acceleration 0 at the left end, the right end, both ends,\n"
             "5 quintic, 6 entry, 7 stop, 8 hold, 9 slowed\n"
             "bit 5: the knot is a waypoint\n"
             "bit 6: the segment that ends here arrives with the acceleration beside the cell\n"
             "bit 7: the segment that begins here starts with the acceleration beside the cell\n"
             "bits 8–14: number of newer knots when the knot was last solved\n"
             "bit 15: the row that belongs to it\n"
             "bit 16: a corner: a run begins here at rest, although the segment before it arrives\n"
             "in motion: the curve was cut while its time law held it. With form 7 and the item\n"
             "beside the cell not 0: a stop that a stopper requested begins here"},
    FieldRow{"velocity", {.per_dimension = 1}, FieldWriter::owner, "doubles"},
    FieldRow{"residual",
             {.per_dimension = 1},
             FieldWriter::owner,
             "doubles, of `smoothing` only: waypoint minus position"}};
inline constexpr auto kCellFields = place(kCellRows);
inline constexpr std::size_t kCellTag = word_of(kCellFields, "tag");
inline constexpr std::size_t kCellVelocity = word_of(kCellFields, "velocity");

inline constexpr std::tuple kNodeRows{
    FieldRow{"time", {.words = 1}, FieldWriter::owner, "ns"},
    FieldRow{"position",
             {.per_dimension = 1},
             FieldWriter::owner,
             "doubles: the waypoint; of a knot that is not a waypoint: position of the curve"}};
inline constexpr auto kNodeFields = place(kNodeRows);
inline constexpr std::size_t kNodeTime = word_of(kNodeFields, "time");
inline constexpr std::size_t kNodePosition = word_of(kNodeFields, "position");

inline constexpr std::tuple kBesideRows{
    FieldRow{"item",
             {.words = 1},
             FieldWriter::owner,
             "valid if bit 6 or 7 of the tag is set\n"
             "where an entry begins: number of the first waypoint's item of the run, plus 1\n"
             "where an entry beyond the newest waypoint ends: waypoints of the run that it knew\n"
             "of a waypoint that is passed over: item of the run · 2²⁴ + its number in the run\n"
             "where a stopper's stop begins: items consumed before · 16 + slot of the stopper\n"
             "else 0"},
    FieldRow{"acceleration",
             {.per_dimension = 1},
             FieldWriter::owner,
             "doubles; valid if bit 6 or 7 of the tag is set"}};
inline constexpr auto kBesideFields = place(kBesideRows);
inline constexpr std::size_t kBesideItem = word_of(kBesideFields, "item");
inline constexpr std::size_t kBesideAcceleration = word_of(kBesideFields, "acceleration");

inline constexpr std::tuple kRowRows{
    FieldRow{
        "gamma", {.words = 1}, FieldWriter::owner, "double: γ of the eliminated row of the knot"},
    FieldRow{"g", {.per_dimension = 1}, FieldWriter::owner, "doubles: right side of that row"},
    FieldRow{"factors",
             {.words = 3},
             FieldWriter::owner,
             "doubles, of `smoothing` only, the row of LDLᵀ:\n"
             "D, L with the knot before, L with the knot before that one"}};
inline constexpr auto kRowFields = place(kRowRows);
inline constexpr std::size_t kRowGamma = word_of(kRowFields, "gamma");
inline constexpr std::size_t kRowG = word_of(kRowFields, "g");

/// Sizes of the rings of refusals and of excesses, and the bit positions in word 0 of an excess.
inline constexpr std::size_t kRefusalsKept = 1024;
inline constexpr std::size_t kExcessesKept = 128;
inline constexpr std::size_t kExcessWords = 4;
inline constexpr unsigned kExcessItemShift = 10;
inline constexpr unsigned kExcessDimensionShift = 4;
inline constexpr std::size_t kOutcomesKept = 256;
inline constexpr std::size_t kOutcomeWords = 2;
inline constexpr std::tuple kBodyRows{
    FieldRow{"refusals",
             {.words = kRefusalsKept},
             FieldWriter::owner,
             "the last 1,024; refusal i is word i mod 1,024: item number · 256 + reason;\n"
             "of a stopped stream item number · 256 + 128 + slot of the stopper"},
    FieldRow{"excesses",
             {.words = kExcessesKept * kExcessWords},
             FieldWriter::owner,
             "the last 128 waypoints with which the curve exceeds a limit, 4 words each:\n"
             "word 0: 0 while it is written, else item number · 1,024 + dimension · 16\n"
             "+ kind · 2 (0 velocity, 1 acceleration, 2 jerk, 3 position) + 1 if it was refused\n"
             "word 1: time, ns; words 2 and 3: value and limit, doubles"},
    FieldRow{"worst excess",
             {.words = 2 * kExcessWords},
             FieldWriter::owner,
             "the largest one, relative to its limit, of all that were not refused: as above;\n"
             "word 0 is 0 before the first excess; the last 4 words are 0"},
    FieldRow{
        "outcomes",
        {.words = kOutcomesKept * kOutcomeWords},
        FieldWriter::owner,
        "the last 256 outcomes other than on the spline at the own time, 2 words each;\n"
        "number i is record i mod 256:\n"
        "word 0: 0 while it is written, else item number · 65,536 + i div 256 mod 256 · 256\n"
        "+ kind (1 to 4 in force by spline, entry, stop, end; 5 passed over; 6 withdrawn)\n"
        "word 1: in force: time, ns; else the first item: all from there to the item of word 0"},
    FieldRow{"stoppers",
             {.words = 2 * kStopperTableWords},
             FieldWriter::owner,
             "two tables of 16 stoppers, one for each cell of the summary: see their part"},
    FieldRow{
        "times",
        {},
        FieldWriter::owner,
        "a word per slot, ns: when the segment of the slot's knot begins; if none begins there,\n"
        "when the next segment begins. A hint: the knots decide"}};
inline constexpr auto kBodyFields = place(kBodyRows);

/// Number of slots after those of the numbered knots. They hold the waypoints that entries pass
/// over and the last waypoints before these: waypoint i of a run is in slot i modulo this number.
/// Only a solver that takes over reads them.
inline constexpr std::size_t kPassedSlots = 80;
inline constexpr unsigned kPassedItemShift = 24;

/// Offsets of a knot board, in bytes; those of a slot's parts count from the slot.
struct BoardLayout {
  std::size_t dimensions;
  std::size_t capacity;
  std::size_t control;
  bool smooths;          ///< cells have residuals, rows have factors
  std::size_t refusals;  ///< kRefusalsKept words
  std::size_t excesses;  ///< kExcessesKept records of kExcessWords words
  std::size_t worst;     ///< one record
  std::size_t outcomes;  ///< kOutcomesKept records of kOutcomeWords words
  std::size_t stoppers;  ///< two tables of kStopperTableWords words
  std::size_t times;     ///< packed times: capacity words
  std::size_t slots;     ///< capacity + kPassedSlots slots
  std::size_t cell;      ///< bytes of a cell; the cells are at offset 0 of a slot
  std::size_t nodes;
  std::size_t node;  ///< bytes of a node
  std::size_t beside;
  std::size_t beside_bytes;
  std::size_t rows;
  std::size_t row;         ///< bytes of a row
  std::size_t stride;      ///< bytes of a slot
  std::size_t commanders;  ///< of a time law: two tables of kCommanderTableWords words; else 0
  std::size_t bytes;

  [[nodiscard]] static BoardLayout of(std::size_t dimensions, std::size_t capacity,
                                      std::size_t control, bool smooths,
                                      bool is_law = false) noexcept;
};

/// The largest capacity: no size or index computed from a header overflows.
inline constexpr std::size_t kMaxBoardCapacity = std::size_t{1} << 22;

/// Maximum length of a stop segment. The sum of any valid time, a stop segment and an entry that
/// returns from it does not overflow.
inline constexpr Time kLongestStop{std::int64_t{1} << 60};

}  // namespace splinecast::ipc
