#include "ipc/law/law_board.hpp"

#include <algorithm>
#include <cstddef>

namespace splinecast::ipc {

bool LawBoard::is_there() noexcept {
  return board_.is_there() && board_.header().is_law != 0 && board_.reader().revision() > 0;
}

std::optional<CommanderEntry> LawBoard::commander(Word id) const noexcept {
  CommanderTable table{};
  seen_ = board_.reader().revision();
  if (!board_.reader().copy_commanders(table)) return std::nullopt;
  for (std::size_t slot = 0; slot < kMostCommanders; ++slot) {
    const auto entry = entry_of(entry_words(table, slot), max_rate());
    if (entry && entry->id == id) return entry;
  }
  return std::nullopt;
}

std::vector<CommanderEntry> LawBoard::commanders() const {
  CommanderTable table{};
  std::vector<CommanderEntry> found;
  if (!board_.reader().copy_commanders(table)) return found;
  for (std::size_t slot = 0; slot < kMostCommanders; ++slot) {
    if (auto entry = entry_of(entry_words(table, slot), max_rate())) found.push_back(*entry);
  }
  return found;
}

void LawBoard::wait(Time timeout) const noexcept { board_.wait(seen_, timeout); }

std::string name_of(const CommanderEntry& entry) {
  return {entry.name.begin(), std::ranges::find(entry.name, '\0')};
}

}  // namespace splinecast::ipc
