#pragma once

#include <cstddef>
#include <tuple>

#include "ipc/layout/table.hpp"

namespace splinecast::ipc {

/// Ring items: kind and flags, time, then position, velocity and acceleration of D words each.
inline constexpr std::tuple kItemRows{
    FieldRow{"kind",
             {.words = 1},
             FieldWriter::owner,
             "kind (bits 0–7: 1 waypoint, 2 replace, 3 start state, 4 finish), velocity given (bit "
             "8), acceleration given (bit 9), end condition of a finish (bits 16–23), waypoints "
             "that follow a replace and belong to it (bits 32–63)"},
    FieldRow{"time", {.words = 1}, FieldWriter::owner, "ns"},
    FieldRow{"position",
             {.per_dimension = 1},
             FieldWriter::owner,
             "doubles; of a replace with waypoints, in the first word: ns that the entry takes at "
             "least"},
    FieldRow{"velocity", {.per_dimension = 1}, FieldWriter::owner, "doubles, where given"},
    FieldRow{"acceleration", {.per_dimension = 1}, FieldWriter::owner, "doubles, where given"}};
inline constexpr auto kItemFields = place(kItemRows);
inline constexpr std::size_t kItemKind = word_of(kItemFields, "kind");
inline constexpr std::size_t kItemTime = word_of(kItemFields, "time");
inline constexpr std::size_t kItemValues = word_of(kItemFields, "position");

/// Offsets of a waypoint ring in bytes, derived from its header.
struct RingLayout {
  std::size_t dimensions;
  std::size_t capacity;
  std::size_t control;
  std::size_t items;
  std::size_t stride;
  std::size_t bytes;

  [[nodiscard]] static RingLayout of(std::size_t dimensions, std::size_t capacity,
                                     std::size_t control) noexcept;
};

/// The largest capacity, so that every size and index computed from a header fits.
inline constexpr std::size_t kMaxRingCapacity = std::size_t{1} << 24;

}  // namespace splinecast::ipc
