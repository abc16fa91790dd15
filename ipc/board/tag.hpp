#pragma once

#include "ipc/board/knot.hpp"

/// The lower bits of a cell's tag: see kCellRows.
namespace splinecast::ipc {

inline constexpr unsigned kTagFormShift = 1;
inline constexpr Word kTagFormMask = 15;
inline constexpr unsigned kTagWaypointBit = 5;
inline constexpr unsigned kTagArrivesBit = 6;
inline constexpr unsigned kTagStartsBit = 7;
inline constexpr unsigned kTagNewerShift = 8;
inline constexpr Word kTagNewerMask = 127;
inline constexpr unsigned kTagRowBit = 15;
inline constexpr unsigned kTagCornerBit = 16;
inline constexpr Word kTagNodeMask = 1;
inline constexpr Word kTagRowMask = Word{1} << kTagRowBit;
inline constexpr Word kTagPartsMask = kTagNodeMask | kTagRowMask;

[[nodiscard]] inline Word pack_note(const KnotNote& note) noexcept {
  return static_cast<Word>(note.form) << kTagFormShift |
         static_cast<Word>(note.is_waypoint) << kTagWaypointBit |
         static_cast<Word>(note.arrives) << kTagArrivesBit |
         static_cast<Word>(note.starts) << kTagStartsBit |
         (note.newer_knots & kTagNewerMask) << kTagNewerShift |
         static_cast<Word>(note.is_corner) << kTagCornerBit;
}

[[nodiscard]] inline bool has_bit(Word tag, unsigned bit) noexcept { return (tag >> bit & 1) != 0; }

[[nodiscard]] inline KnotNote note_of(Word tag) noexcept {
  return {.form = static_cast<core::SegmentForm>(tag >> kTagFormShift & kTagFormMask),
          .is_waypoint = has_bit(tag, kTagWaypointBit),
          .arrives = has_bit(tag, kTagArrivesBit),
          .starts = has_bit(tag, kTagStartsBit),
          .newer_knots = static_cast<std::uint32_t>(tag >> kTagNewerShift & kTagNewerMask),
          .is_corner = has_bit(tag, kTagCornerBit)};
}

[[nodiscard]] inline std::size_t node_of(Word tag) noexcept { return tag & 1; }
[[nodiscard]] inline std::size_t row_of(Word tag) noexcept { return tag >> kTagRowBit & 1; }

}  // namespace splinecast::ipc
