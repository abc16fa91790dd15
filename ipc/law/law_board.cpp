#include "ipc/law/law_board.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "ipc/mapping/checked_region.hpp"
#include "ipc/memory/futex.hpp"
#include "splinecast/errors.hpp"

namespace splinecast::ipc {

bool LawBoard::is_there() noexcept {
  if (board_ && board_->reader.retired()) board_.reset();
  if (board_) return board_->reader.revision() > 0;
  try {
    auto [region, header, layout] = open_board(law_, false, trust_);
    if (header.is_law == 0) return false;
    KnotBoardReader reader(region.bytes(), layout);
    region.close_descriptor();
    board_ = Board{std::move(region), header, std::move(reader)};
    return board_->reader.revision() > 0;
  } catch (const StreamError&) {
    return false;
  }
}

std::optional<CommanderEntry> LawBoard::commander(Word id) const noexcept {
  CommanderTable table{};
  seen_ = board_->reader.revision();
  if (!board_->reader.copy_commanders(table)) return std::nullopt;
  for (std::size_t slot = 0; slot < kMostCommanders; ++slot) {
    const auto entry = entry_of(entry_words(table, slot), largest_rate());
    if (entry && entry->id == id) return entry;
  }
  return std::nullopt;
}

std::vector<CommanderEntry> LawBoard::commanders() const {
  CommanderTable table{};
  std::vector<CommanderEntry> found;
  if (!board_->reader.copy_commanders(table)) return found;
  for (std::size_t slot = 0; slot < kMostCommanders; ++slot) {
    if (auto entry = entry_of(entry_words(table, slot), largest_rate())) found.push_back(*entry);
  }
  return found;
}

void LawBoard::wait(Time timeout) const noexcept {
  wait_while_equal(board_->reader.revision_word(), seen_, timeout);
}

std::string name_of(const CommanderEntry& entry) {
  return {entry.name.begin(), std::ranges::find(entry.name, '\0')};
}

}  // namespace splinecast::ipc
