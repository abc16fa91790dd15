#include "ipc/board/reader.hpp"
#include "ipc/board/writer.hpp"
#include "ipc/layout/knot_slots.hpp"
#include "ipc/memory/word.hpp"

/// The end of the board that a board has replaced.
namespace splinecast::ipc {
namespace {

/// The time of the node that holds it: no knot has this time.
constexpr Time kMark = Time::min();

}  // namespace

void KnotBoardWriter::write_old_end(std::span<const double> position) noexcept {
  Word* const node = at_.slot(0) + layout_.nodes / sizeof(Word);
  store_values(node + kNodePosition, position);
  store(node[kNodeTime], to_word(kMark), std::memory_order_release);
}

bool KnotBoardReader::has_old_end() const noexcept {
  const Word* const node = slot_at(0) + layout_.nodes / sizeof(Word);
  return to_time(load(node[kNodeTime], std::memory_order_acquire)) == kMark;
}

bool KnotBoardReader::copy_old_end(std::span<double> position) const noexcept {
  if (!has_old_end()) return false;
  load_values(position, slot_at(0) + layout_.nodes / sizeof(Word) + kNodePosition);
  return true;
}

}  // namespace splinecast::ipc
