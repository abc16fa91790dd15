#include "ipc/verification/settled_segments.hpp"

#include <algorithm>
#include <utility>

namespace splinecast::ipc {
namespace {

constexpr int kTries = 16;

}  // namespace

SettledSegments::SettledSegments(const KnotBoardReader& board, bool is_held_before_start)
    : board_(&board),
      is_held_before_start_(is_held_before_start),
      copies_{BoardSegment(board.dimensions(), board.smooths()),
              BoardSegment(board.dimensions(), board.smooths())},
      start_(board.dimensions()),
      end_(board.dimensions()) {}

void SettledSegments::look(Time final_until) {
  for (int attempt = 0; attempt < kTries; ++attempt) {
    const Look look = board_->look();
    const bool is_seen =
        look.revision == seen_.revision && look.settled_until == seen_.settled_until;
    if (is_seen && !waits_) return;
    if (!take(look, final_until)) continue;
    seen_ = look;
    return;
  }
}

/// Takes the segments that have settled under a revision; false if the writer overtook it.
bool SettledSegments::take(const Look& look, Time final_until) {
  if (!board_->copy_summary(look, summary_)) return false;
  waits_ = false;
  is_open_ = false;
  if (summary_.newest == 0) return true;
  Word number = std::max(next_, summary_.first);
  while (number <= summary_.newest) {
    const BoardSegment& before = copy();
    last_ = 1 - last_;
    const BoardSegment::Taken taken = copies_[last_].take(*board_, summary_, number, &before);
    if (taken == BoardSegment::Taken::torn) return false;
    if (taken == BoardSegment::Taken::none) break;  // the end of a finished curve
    until_ = std::min(summary_.settled_until, final_until);
    is_open_ = !summary_.finished && copy().right() > until_;
    waits_ = is_open_ && copy().right() <= summary_.settled_until;
    if (is_open_) break;
    keep();
    if (copy().is_last(summary_)) break;
    number = copy().next();
  }
  return true;
}

std::optional<OpenSegment> SettledSegments::open() const {
  if (!is_open_ || copy().left() >= until_) return std::nullopt;
  OpenSegment open{.until = until_, .segment = {}};
  copy().copy_to(open.segment);
  return open;
}

/// Keeps the segment that has been copied, with its acceleration step if the one before is known.
void SettledSegments::keep() {
  SegmentCopy segment;
  copy().copy_to(segment);
  copy().write_accelerations(start_, end_);
  if (next_ == segment.number && segment.number > 1) {
    segment.acceleration_step.resize(start_.size());
    for (std::size_t d = 0; d < start_.size(); ++d) {
      segment.acceleration_step[d] = start_[d] - arrival_[d];
    }
  } else if (segment.number == 1) {
    const bool is_held = is_held_before_start_ && segment.has_waypoint;
    segment.acceleration_step = is_held ? start_ : std::vector<double>(start_.size());
  }
  arrival_ = end_;
  next_ = segment.next;
  segments_.push_back(std::move(segment));
}

}  // namespace splinecast::ipc
