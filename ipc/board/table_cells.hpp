#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "ipc/layout/publication.hpp"
#include "ipc/memory/word.hpp"

namespace splinecast::ipc {

/// The writer's side of a table of which a board has two copies, one for each cell of the summary:
/// a part of that cell, as W2. Allocates only when constructed.
class TableCells {
 public:
  /// `words`: both copies; empty if the board has no such table.
  explicit TableCells(std::span<Word> words) : words_(words), next_(words.size() / 2) {}

  [[nodiscard]] bool empty() const noexcept { return next_.empty(); }

  /// The table of the next revision.
  [[nodiscard]] std::span<const Word> next() const noexcept { return next_; }

  /// Sets the table of the next revision.
  void set(std::span<const Word> table) noexcept;

  /// The next revision has the table of this cell.
  void take_back(std::size_t cell) noexcept;

  /// Stores those words of the next table that differ from the cell's. O(1) if the cell is known to
  /// have it.
  void write(std::size_t cell) noexcept;

 private:
  [[nodiscard]] std::span<Word> cell(std::size_t index) const noexcept {
    return words_.subspan(index * next_.size(), next_.size());
  }

  std::span<Word> words_;
  std::vector<Word> next_;
  std::array<bool, 2> has_next_{};  ///< the cell is known to hold next_
};

}  // namespace splinecast::ipc
