#pragma once

#include <algorithm>
#include <vector>

#include "splinecast/ipc/segment_board.hpp"

namespace splinecast::campaign {

/// From when on each revision of a board changed the curve: what readers must be told, and no more.
class RevisionLog {
 public:
  explicit RevisionLog(const ipc::SegmentBoardReader& board) : board_(&board) {}

  /// Takes a new revision in; to be called after each. Returns whether none was missed.
  bool catch_up() {
    const ipc::Word r = board_->revision();
    if (r == changed_from_.size()) return true;
    ipc::Head head;
    if (r != changed_from_.size() + 1 || !board_->copy_head(r, head)) return false;
    changed_from_.push_back(head.changed_from);
    if (head.first == 1) (void)board_->copy_left(1, r, start_);
    return true;
  }

  /// When the curve begins, as far as the board still said so.
  [[nodiscard]] core::Time start() const noexcept { return start_; }

  /// The earliest change of the revisions after `seen` up to r.
  [[nodiscard]] core::Time earliest(ipc::Word seen, ipc::Word r) const {
    core::Time earliest = core::Time::max();
    for (ipc::Word i = seen; i < std::min<ipc::Word>(r, changed_from_.size()); ++i) {
      earliest = std::min(earliest, changed_from_[i]);
    }
    return earliest;
  }

 private:
  const ipc::SegmentBoardReader* board_;
  std::vector<core::Time> changed_from_;
  core::Time start_ = core::Time::max();
};

}  // namespace splinecast::campaign
