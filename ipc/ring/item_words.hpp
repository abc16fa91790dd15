#pragma once

#include <cstddef>

#include "ipc/layout/waypoint_items.hpp"
#include "ipc/memory/word.hpp"

/// The bits of an item's word kItemKind, and the size of an item in words: see kItemRows.
namespace splinecast::ipc {

inline constexpr Word kKindMask = 0xff;  ///< of ItemKind and, after its shift, of ConditionKind
inline constexpr Word kHasVelocity = 1U << 8;
inline constexpr Word kHasAcceleration = 1U << 9;
inline constexpr unsigned kConditionShift = 16;  ///< of a finish
inline constexpr unsigned kCommanderShift = 16;  ///< of a piece: slot of the commander
inline constexpr unsigned kPlaceShift = 24;      ///< of a piece: its number in the plan
inline constexpr unsigned kCountShift = 32;      ///< of a replacement: waypoints that belong to it;
                                                 ///< of a piece: pieces after it

/// Words from one item to the next.
[[nodiscard]] inline std::size_t words_per_item(const RingLayout& layout) noexcept {
  return layout.stride / sizeof(Word);
}

}  // namespace splinecast::ipc
