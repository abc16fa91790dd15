#include "support/torn_publication.hpp"

namespace splinecast::testing {

TornPublication::TornPublication(MemoryBoard& board)
    : layout_(&board.layout),
      words_(ipc::words_at(board.bytes.span(), 0, board.layout.bytes / sizeof(ipc::Word))),
      before_(words_.begin(), words_.end()) {}

void TornPublication::take_back_commit() { take_back_control(0); }

void TornPublication::take_back_rest() { take_back_control(ipc::kRevision + 1); }

void TornPublication::take_back_control(std::size_t first) {
  const std::size_t control = layout_->control / sizeof(ipc::Word);
  for (std::size_t i = first; i < ipc::kHeadSlot; ++i) take_back_word(control + i);
}

void TornPublication::take_back(const std::function<bool()>& is_stored) {
  take_back_commit();
  const std::size_t slots = layout_->slots / sizeof(ipc::Word);
  const std::size_t stride = layout_->stride / sizeof(ipc::Word);
  const std::size_t head = layout_->control / sizeof(ipc::Word) + ipc::kHeadSlot;
  const auto is_tag = [&](std::size_t i) {
    if (i < slots) return i == head || i == head + ipc::kHeadWords;
    const std::size_t word = (i - slots) % stride;
    return word == 0 || word == layout_->cell / sizeof(ipc::Word);
  };
  for (std::size_t i = head; i < words_.size(); ++i) {
    if (words_[i] != before_[i] && !is_tag(i) && !is_stored()) take_back_word(i);
  }
}

}  // namespace splinecast::testing
