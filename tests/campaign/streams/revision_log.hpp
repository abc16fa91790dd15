#pragma once

#include <algorithm>
#include <vector>

#include "ipc/board/reader.hpp"
#include "ipc/layout/summary.hpp"

namespace splinecast::campaign {

/// The time from which each revision of a board changed the curve. Readers must get `revised` for
/// these changes, and for no others.
class RevisionLog {
 public:
  explicit RevisionLog(const ipc::KnotBoardReader& board) : board_(&board) {}

  /// Records a new revision. Call it after each revision. Returns false if a revision was missed.
  bool catch_up() {
    const ipc::Look look = board_->look();
    if (look.revision == changed_from_.size()) return true;
    ipc::Summary summary;
    if (look.revision != changed_from_.size() + 1 || !board_->copy_summary(look, summary))
      return false;
    changed_from_.push_back(summary.changed_from);
    core::SegmentForm form{};
    if (summary.first == 1) (void)board_->copy_time(1, look.revision, start_, form);
    return true;
  }

  /// Start of the curve; Time::max() if the board has already overwritten it.
  [[nodiscard]] Time start() const noexcept { return start_; }

  /// The earliest change of the revisions seen + 1 to r.
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
