#include "ipc/sampling/kept_segments.hpp"

#include <numeric>

namespace splinecast::ipc {

KeptSegments::KeptSegments(std::size_t dimensions, bool smooths)
    : copies_(kMost + 1, Kept{BoardSegment(dimensions, smooths)}), current_(copies_.data()) {
  std::iota(places_.begin(), places_.end(), std::uint8_t{0});
}

bool KeptSegments::is_confirmed(const KnotBoardReader& board, const Head& head) noexcept {
  if (confirmed_ == head.revision) return true;
  const bool stands = current().is_current(board, head);
  if (stands) confirm(head);
  return stands;
}

/// Makes a copy that is part of the summary's revision the current one.
void KeptSegments::confirm(Kept& copy, const Head& head) noexcept {
  current_ = &copy;
  confirm(head);
}

void KeptSegments::confirm(const Head& head) noexcept {
  current_->known_by = head.revision;
  confirmed_ = head.revision;
  settled_until_ = head.settled_until;
  const BoardSegment& own = current();
  const bool moves = own.kind() == SegmentKind::spline || own.kind() == SegmentKind::entry;
  at_hand_ = {
      .left = own.left(), .right = moves ? own.right() : own.left(), .is_finished = head.finished};
}

bool KeptSegments::take(const KnotBoardReader& board, const Head& head, Word number) noexcept {
  Kept& kept = copies_[place_of(number)];
  const bool is_kept = kept.segment.is_there() && kept.segment.number() == number;
  if (is_kept && (kept.known_by == head.revision || kept.segment.is_current(board, head))) {
    confirm(kept, head);
    return true;
  }
  BoardSegment& copy = spare();
  BoardSegment::Taken taken = copy.take(board, head, number, &current());
  if (taken == BoardSegment::Taken::none && number > head.first) {
    taken = copy.take(board, head, number - 1, &current());
  }
  if (taken != BoardSegment::Taken::whole) return false;
  std::uint8_t& place = place_of(copy.number());
  const std::size_t freed = place;
  place = static_cast<std::uint8_t>(spare_);
  confirm(copies_[spare_], head);
  spare_ = freed;
  return true;
}

}  // namespace splinecast::ipc
