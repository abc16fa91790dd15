#pragma once

#include <algorithm>
#include <vector>

#include "ipc/board/reader.hpp"
#include "ipc/layout/summary.hpp"

namespace splinecast::campaign {

/// From when on each revision of a board changed the curve: what readers must be told, and no more.
class RevisionLog {
 public:
  explicit RevisionLog(const ipc::KnotBoardReader& board) : board_(&board) {}

  /// Takes a new revision in; to be called after each. Returns whether none was missed.
  bool catch_up() {
    const ipc::Look look = board_->look();
    if (look.revision == changed_from_.size()) return true;
    ipc::Head head;
    if (look.revision != changed_from_.size() + 1 || !board_->copy_head(look, head)) return false;
    changed_from_.push_back(head.changed_from);
    core::SegmentForm form{};
    if (head.first == 1) (void)board_->copy_time(1, look.revision, start_, form);
    return true;
  }

  /// When the curve begins, as far as the board still said so.
  [[nodiscard]] Time start() const noexcept { return start_; }

  /// The earliest change of the revisions after `seen` up to r.
  [[nodiscard]] Time earliest(ipc::Word seen, ipc::Word r) const {
    Time earliest = Time::max();
    for (ipc::Word i = seen; i < std::min<ipc::Word>(r, changed_from_.size()); ++i) {
      earliest = std::min(earliest, changed_from_[i]);
    }
    return earliest;
  }

 private:
  const ipc::KnotBoardReader* board_;
  std::vector<Time> changed_from_;
  Time start_ = Time::max();
};

}  // namespace splinecast::campaign
