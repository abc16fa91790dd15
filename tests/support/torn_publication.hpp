#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "support/memory_stream.hpp"

namespace splinecast::testing {

/// Keeps the board's bytes from before a step of its solver and simulates a death within that step:
/// takes back what the solver had not yet stored.
class TornPublication {
 public:
  /// Keeps the words of a board, before the step.
  explicit TornPublication(MemoryBoard& board);

  /// After the step: all words of the revision are stored, its commit is not.
  void take_back_commit();

  /// After the step: the revision is committed, what is stored behind it in the control lines is
  /// not.
  void take_back_rest();

  /// After the step: the commit and every word for which `is_stored` is false are taken back. Tags
  /// stay: a cell's tag is stored before its words.
  void take_back(const std::function<bool()>& is_stored);

 private:
  void take_back_control(std::size_t first);
  void take_back_word(std::size_t i) { words_[i] = before_[i]; }

  const ipc::BoardLayout* layout_;
  std::span<ipc::Word> words_;
  std::vector<ipc::Word> before_;
};

}  // namespace splinecast::testing
