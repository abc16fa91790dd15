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
             "bits 0–7: 1 waypoint, 2 replace, 3 start state, 4 finish, 5 rate\n"
             "bit 8: has a velocity; bit 9: has an acceleration\n"
             "bits 16–23, of a finish: end condition, numbered as the start condition\n"
             "bits 16–23, of a rate: slot of the commander whose request it follows\n"
             "bits 24–31, of a rate: number of the piece in its plan, from 0\n"
             "bits 32–63: of a replace, number of waypoints that follow and belong to it;\n"
             "of a rate, number of pieces of the plan that follow"},
    FieldRow{"time",
             {.words = 1},
             FieldWriter::owner,
             "ns; of a finish: that of the last item before it; of a rate: when the piece begins"},
    FieldRow{"position",
             {.per_dimension = 1},
             FieldWriter::owner,
             "doubles\n"
             "of a replace with waypoints, in the first word: shortest length of its entry, ns\n"
             "of a rate: the law's rate at the end of the piece"},
    FieldRow{"velocity",
             {.per_dimension = 1},
             FieldWriter::owner,
             "doubles, if bit 8 of the kind is set; of a rate: length of the piece, s"},
    FieldRow{"acceleration",
             {.per_dimension = 1},
             FieldWriter::owner,
             "doubles, if bit 9 of the kind is set; of a rate: number of the request"}};
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

/// The largest capacity: no size or index computed from a header overflows.
inline constexpr std::size_t kMaxRingCapacity = std::size_t{1} << 24;

}  // namespace splinecast::ipc
