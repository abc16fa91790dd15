#include "ipc/owned/stoppers.hpp"

namespace splinecast::ipc {

std::vector<StopperEntry> stoppers_of(const KnotBoardReader& board) {
  StopperTable::Words words{};
  std::vector<StopperEntry> found;
  if (!board.copy_stoppers(words)) return found;
  for (std::size_t slot = 0; slot < kMostStoppers; ++slot) {
    if (auto entry = stopper_in(words, slot)) found.push_back(std::move(*entry));
  }
  return found;
}

std::vector<std::string> holders_of(const KnotBoardReader& board) {
  std::vector<std::string> names;
  for (StopperEntry& entry : stoppers_of(board)) {
    if (entry.holds) names.push_back(std::move(entry.name));
  }
  return names;
}

std::string stopper_of(const KnotBoardReader& board, std::size_t slot) {
  StopperTable::Words words{};
  const auto entry = board.copy_stoppers(words) ? stopper_in(words, slot) : std::nullopt;
  return entry ? entry->name : std::string();
}

}  // namespace splinecast::ipc
