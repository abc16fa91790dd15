#include "ipc/board/named_board.hpp"

#include "ipc/memory/futex.hpp"
#include "splinecast/errors.hpp"

namespace splinecast::ipc {

bool NamedBoard::is_there() noexcept {
  if (board_ && board_->reader.retired()) board_.reset();
  if (board_) return true;
  try {
    board_.emplace(open_board(stream_, false, trust_));
    return true;
  } catch (const StreamError&) {
    return false;
  }
}

void NamedBoard::wait(Word seen, Time timeout) const noexcept {
  wait_while_equal(board_->reader.revision_word(), seen, timeout);
}

}  // namespace splinecast::ipc
