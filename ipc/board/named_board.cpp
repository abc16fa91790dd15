#include "ipc/board/named_board.hpp"

#include <utility>

#include "ipc/mapping/checked_region.hpp"
#include "ipc/memory/futex.hpp"
#include "splinecast/errors.hpp"

namespace splinecast::ipc {

bool NamedBoard::is_there() noexcept {
  if (board_ && board_->reader.retired()) board_.reset();
  if (board_) return true;
  try {
    auto [region, header, layout] = open_board(stream_, false, trust_);
    KnotBoardReader reader(region.bytes(), layout);
    region.close_descriptor();
    board_ = Board{std::move(region), header, std::move(reader)};
    return true;
  } catch (const StreamError&) {
    return false;
  }
}

void NamedBoard::wait(Word seen, Time timeout) const noexcept {
  wait_while_equal(board_->reader.revision_word(), seen, timeout);
}

}  // namespace splinecast::ipc
