#pragma once

#include <string_view>

#include "splinecast/ipc/layout.hpp"

/// Where the words of a spline region lie, for tests that look at bytes or change them: byte
/// offsets from the beginning of the region. `c` is 0 or 1: parts of a slot lie there twice.
namespace splinecast::testing {

inline std::size_t slot_offset(const ipc::BoardLayout& layout, ipc::Word number) {
  return layout.slots + number % layout.capacity * layout.stride;
}
inline std::size_t cell_offset(const ipc::BoardLayout& layout, ipc::Word number, std::size_t c) {
  return slot_offset(layout, number) + c * layout.cell;
}
inline std::size_t node_offset(const ipc::BoardLayout& layout, ipc::Word number, std::size_t c) {
  return slot_offset(layout, number) + layout.nodes + c * layout.node;
}
inline std::size_t beside_offset(const ipc::BoardLayout& layout, ipc::Word number, std::size_t c) {
  return slot_offset(layout, number) + layout.beside + c * layout.beside_bytes;
}
inline std::size_t row_offset(const ipc::BoardLayout& layout, ipc::Word number, std::size_t c) {
  return slot_offset(layout, number) + layout.rows + c * layout.row;
}
inline std::size_t head_offset(const ipc::BoardLayout& layout, std::size_t c) {
  return layout.control + (ipc::kHeadSlot + c * ipc::kHeadWords) * sizeof(ipc::Word);
}

/// The offset of a field of the head from the beginning of a cell, in words.
consteval std::size_t head_word(std::string_view name) {
  return ipc::word_of(ipc::kHeadFields, name);
}

}  // namespace splinecast::testing
