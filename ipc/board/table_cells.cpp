#include "ipc/board/table_cells.hpp"

#include <algorithm>

namespace splinecast::ipc {

void TableCells::set(std::span<const Word> table) noexcept {
  const auto given = table.first(next_.size());
  if (std::ranges::equal(given, next_)) return;
  std::ranges::copy(given, next_.begin());
  has_next_ = {};
}

void TableCells::take_back(std::size_t index) noexcept {
  if (has_next_[index]) return;
  const auto words = cell(index);
  for (std::size_t i = 0; i < words.size(); ++i) {
    next_[i] = load(words[i], std::memory_order_relaxed);
  }
  has_next_ = {};
  has_next_[index] = true;
}

void TableCells::write(std::size_t index) noexcept {
  if (has_next_[index]) return;
  const auto words = cell(index);
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (load(words[i], std::memory_order_relaxed) != next_[i]) put(words[i], next_[i]);
  }
  has_next_[index] = true;
}

}  // namespace splinecast::ipc
