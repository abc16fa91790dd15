#include "splinecast/ipc/settled_segments.hpp"

#include <algorithm>

namespace splinecast::ipc {
namespace {

constexpr int kTries = 16;

}  // namespace

SettledSegments::SettledSegments(const SegmentBoardReader& board)
    : board_(&board), copy_(board.dimensions()) {}

void SettledSegments::look() {
  for (int attempt = 0; attempt < kTries; ++attempt) {
    const Word r = board_->revision();
    if (r == seen_) return;
    if (!take(r)) continue;
    seen_ = r;
    return;
  }
}

/// Takes what has settled under a revision; false if the writer went on meanwhile.
bool SettledSegments::take(Word r) {
  if (!board_->copy_head(r, head_)) return false;
  const Word next = segments_.empty() ? 1 : segments_.back().number + 1;
  const std::size_t dimensions = board_->dimensions();
  for (Word number = std::max(next, head_.first); number <= head_.newest && number > 0; ++number) {
    copy_.coefficients.resize(static_cast<std::size_t>(core::kMaxOrder) * dimensions);
    if (!board_->copy_segment(number, r, copy_)) return false;
    if (!head_.finished && copy_.right > head_.settled_until) break;
    copy_.coefficients.resize(static_cast<std::size_t>(copy_.order) * dimensions);
    copy_.acceleration_step.resize(dimensions);
    copy_.waypoint.resize(copy_.has_waypoint ? dimensions : 0);
    board_->copy_step(copy_, copy_.acceleration_step);
    board_->copy_waypoint(copy_, copy_.waypoint);
    if (!board_->is_current(copy_, r)) return false;
    segments_.push_back(copy_);
  }
  return true;
}

}  // namespace splinecast::ipc
