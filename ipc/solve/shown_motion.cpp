#include "ipc/solve/shown_motion.hpp"

#include <algorithm>

#include "ipc/board/reader.hpp"
#include "ipc/layout/knot_slots.hpp"
#include "ipc/layout/summary.hpp"
#include "ipc/runs/curve_cut.hpp"

namespace splinecast::ipc {

ShownMotion::ShownMotion(const KnotBoardReader& board)
    : ShownLimits(board.dimensions()),
      before_cut_(board.dimensions()),
      numbers_(kMost),
      knot_(board.dimensions(), board.smooths()) {}

void ShownMotion::restore(const KnotBoardReader& board, const Summary& summary, Time end) noexcept {
  forget_all();
  if (summary.newest > 0) take_met(board, summary, end);
}

void ShownMotion::restore(const core::SlidingWindow& window, const KnotBoardReader& board,
                          const Summary& summary, Time end, std::size_t first) noexcept {
  restore(board, summary, end);
  is_restored_ = true;
  if (window.knots() == 0) return;
  take_passed(board, summary, first, window.oldest_segment());
  for (std::size_t i = std::max(first, window.oldest_segment()); i < window.knots(); ++i) {
    const core::Knot knot = window.knot(i);
    note(knot.time, knot.waypoint);
  }
}

void ShownMotion::begin_cut() noexcept {
  before_cut_ = static_cast<const ShownLimits&>(*this);
  has_cut_ = true;
}

void ShownMotion::discarded() noexcept {
  if (has_cut_) static_cast<ShownLimits&>(*this) = before_cut_;
  has_cut_ = false;
}

/// Takes the first knot at or after each multiple of kStep, searched backwards from `end` by the
/// packed times.
void ShownMotion::take_met(const KnotBoardReader& board, const Summary& summary,
                           Time end) noexcept {
  const Time newest = std::min(end, board.time_hint(summary.newest));
  if (!is_time_in_range(newest)) return;
  Time t = (newest / kStep + 1) * kStep;
  std::size_t found = 0;
  for (std::size_t i = 0; i < kMost; ++i, t -= kStep) {
    const Word before = segment_at(board, summary, t - Time(1));
    const bool is_first = before == summary.first && board.time_hint(before) >= t;
    const Word number = std::min(is_first ? before : before + 1, summary.newest);
    if (found == 0 || number != numbers_[found - 1]) numbers_[found++] = number;
    if (before == summary.first) break;
  }
  while (found > 0) {
    const bool is_there = board.copy_knot(numbers_[--found], summary.revision, knot_);
    const bool is_met = is_there && knot_.note.is_waypoint && knot_.time < end &&
                        knot_.note.form != core::SegmentForm::none;
    if (is_met) note(knot_.time, knot_.waypoint());
  }
}

void ShownMotion::take_passed(const KnotBoardReader& board, const Summary& summary,
                              std::size_t first, std::size_t end) noexcept {
  first = std::max(first, end - std::min(end, kPassedSlots));
  for (std::size_t i = first; i < end; ++i) {
    const bool is_there = board.copy_passed(i, summary.revision, knot_) && knot_.note.is_waypoint &&
                          knot_.item == (summary.run_item << kPassedItemShift | i);
    if (is_there) note(knot_.time, knot_.waypoint());
  }
}

}  // namespace splinecast::ipc
