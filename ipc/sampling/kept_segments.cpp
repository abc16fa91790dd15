#include "ipc/sampling/kept_segments.hpp"

#include <numeric>

namespace splinecast::ipc {

KeptSegments::KeptSegments(std::size_t dimensions, bool smooths)
    : copies_(kMost + 1, Kept{BoardSegment(dimensions, smooths)}), current_(copies_.data()) {
  std::iota(places_.begin(), places_.end(), std::uint8_t{0});
}

bool KeptSegments::is_confirmed(const KnotBoardReader& board, const Summary& summary) noexcept {
  if (confirmed_ == summary.revision) return true;
  const bool is_valid = current().is_current(board, summary);
  if (is_valid) confirm(summary);
  return is_valid;
}

/// Makes `copy` the current copy, and confirms it. It must be part of the summary's revision.
void KeptSegments::confirm(Kept& copy, const Summary& summary) noexcept {
  current_ = &copy;
  confirm(summary);
}

void KeptSegments::confirm(const Summary& summary) noexcept {
  current_->known_by = summary.revision;
  confirmed_ = summary.revision;
  settled_until_ = summary.settled_until;
  const BoardSegment& own = current();
  const bool moves = own.kind() != SegmentKind::stop && own.kind() != SegmentKind::hold;
  current_interval_ = {.left = own.left(),
                       .right = moves ? own.right() : own.left(),
                       .is_finished = summary.finished};
}

bool KeptSegments::take(const KnotBoardReader& board, const Summary& summary,
                        Word number) noexcept {
  Kept& kept = copies_[place_of(number)];
  const bool is_kept = kept.segment.is_there() && kept.segment.number() == number;
  if (is_kept && (kept.known_by == summary.revision || kept.segment.is_current(board, summary))) {
    confirm(kept, summary);
    return true;
  }
  BoardSegment& copy = spare();
  BoardSegment::Taken taken = copy.take(board, summary, number, &current());
  if (taken == BoardSegment::Taken::none && number > summary.first) {
    taken = copy.take(board, summary, number - 1, &current());
  }
  if (taken != BoardSegment::Taken::whole) return false;
  std::uint8_t& place = place_of(copy.number());
  const std::size_t freed = place;
  place = static_cast<std::uint8_t>(spare_);
  confirm(copies_[spare_], summary);
  spare_ = freed;
  return true;
}

}  // namespace splinecast::ipc
