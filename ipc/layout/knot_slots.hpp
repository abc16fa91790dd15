#pragma once

#include <cstddef>
#include <cstdint>
#include <tuple>

#include "ipc/layout/table.hpp"
#include "splinecast/time.hpp"

namespace splinecast::ipc {

/// The parts of a knot's slot. Each exists twice and begins on a cache line.
inline constexpr std::tuple kCellRows{
    FieldRow{"tag",
             {.words = 1},
             FieldWriter::owner,
             "0 never written; else revision (bits 16–63; all ones: retired), the node that it "
             "refers to (bit 0), the form of the segment that begins here (bits 1–4: 0 none, 1 "
             "cubic, 2 cubic with acceleration 0 at the left end, 3 at the right end, 4 at both, 5 "
             "quintic, 6 entry, 7 stop, 8 hold), the knot is a waypoint (bit 5), the acceleration "
             "beside is that with which the segment that ends here arrives (bit 6), or the one "
             "that begins here starts (bit 7), how many newer knots it had seen when it was solved "
             "(bits 8–14), the row that it refers to (bit 15)"},
    FieldRow{"velocity", {.per_dimension = 1}, FieldWriter::owner, "doubles"},
    FieldRow{"residual",
             {.per_dimension = 1},
             FieldWriter::owner,
             "doubles, of `smoothing` only: waypoint less position"}};
inline constexpr auto kCellFields = place(kCellRows);
inline constexpr std::size_t kCellTag = word_of(kCellFields, "tag");
inline constexpr std::size_t kCellVelocity = word_of(kCellFields, "velocity");

inline constexpr std::tuple kNodeRows{FieldRow{"time", {.words = 1}, FieldWriter::owner, "ns"},
                                      FieldRow{"position",
                                               {.per_dimension = 1},
                                               FieldWriter::owner,
                                               "doubles: of the waypoint, else of the curve"}};
inline constexpr auto kNodeFields = place(kNodeRows);
inline constexpr std::size_t kNodeTime = word_of(kNodeFields, "time");
inline constexpr std::size_t kNodePosition = word_of(kNodeFields, "position");

inline constexpr std::tuple kBesideRows{
    FieldRow{"item",
             {.words = 1},
             FieldWriter::owner,
             "of an entry: number of the item of the run's first waypoint, plus 1; of the end of "
             "one beyond the newest waypoint: number of waypoints of the run; of a waypoint that "
             "is passed over: item of the run · 2²⁴ + its number in the run; else 0"},
    FieldRow{"acceleration",
             {.per_dimension = 1},
             FieldWriter::owner,
             "doubles, where the tag says so"}};
inline constexpr auto kBesideFields = place(kBesideRows);
inline constexpr std::size_t kBesideItem = word_of(kBesideFields, "item");
inline constexpr std::size_t kBesideAcceleration = word_of(kBesideFields, "acceleration");

inline constexpr std::tuple kRowRows{
    FieldRow{"gamma", {.words = 1}, FieldWriter::owner, "double: γ of the knot's eliminated row"},
    FieldRow{"g", {.per_dimension = 1}, FieldWriter::owner, "doubles: its right side"},
    FieldRow{"factors",
             {.words = 3},
             FieldWriter::owner,
             "doubles, of `smoothing` only: the row of LDLᵀ: D, L with the knot before, L with the "
             "one before that"}};
inline constexpr auto kRowFields = place(kRowRows);
inline constexpr std::size_t kRowGamma = word_of(kRowFields, "gamma");
inline constexpr std::size_t kRowG = word_of(kRowFields, "g");

/// The ring of refusals.
inline constexpr std::size_t kRefusalsKept = 1024;
inline constexpr std::size_t kExcessesKept = 128;
inline constexpr std::size_t kExcessWords = 4;
inline constexpr unsigned kExcessItemShift = 10;
inline constexpr unsigned kExcessDimensionShift = 4;
inline constexpr std::tuple kBodyRows{
    FieldRow{"refusals",
             {.words = kRefusalsKept},
             FieldWriter::owner,
             "the last 1,024: item number · 256 + reason"},
    FieldRow{"excesses",
             {.words = kExcessesKept * kExcessWords},
             FieldWriter::owner,
             "the last 128 waypoints with which a limit was passed, 4 words each: 0 while it is "
             "written, else item number · 1,024 + dimension · 16 + kind (0 velocity, 1 "
             "acceleration, 2 jerk, 3 position) · 2 + 1 if it was refused; when, in ns; the value, "
             "and the limit, as doubles"},
    FieldRow{"times",
             {},
             FieldWriter::owner,
             "a word per slot: ns at which the segment of the slot's knot begins, or, where none "
             "begins, the one of the next knot at which one does: a hint"}};
inline constexpr auto kBodyFields = place(kBodyRows);

/// Slots after those of the numbered knots: the waypoints that entries pass over, by their number
/// in the run. Only a solver that takes over reads them.
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
  std::size_t times;     ///< packed times: capacity words
  std::size_t slots;     ///< capacity + kPassedSlots slots
  std::size_t cell;      ///< bytes of a cell; cells begin a slot
  std::size_t nodes;
  std::size_t node;  ///< bytes of a node
  std::size_t beside;
  std::size_t beside_bytes;
  std::size_t rows;
  std::size_t row;     ///< bytes of a row
  std::size_t stride;  ///< bytes of a slot
  std::size_t bytes;

  [[nodiscard]] static BoardLayout of(std::size_t dimensions, std::size_t capacity,
                                      std::size_t control, bool smooths) noexcept;
};

/// The largest capacity, so that every size and index computed from a header fits.
inline constexpr std::size_t kMaxBoardCapacity = std::size_t{1} << 22;

/// Greatest length of a stop segment: a stop and a return from it can be added to any time.
inline constexpr Time kLongestStop{std::int64_t{1} << 60};

}  // namespace splinecast::ipc
