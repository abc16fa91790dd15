#include "ipc/roles/refusals.hpp"

#include <algorithm>
#include <span>

#include "ipc/owned/stoppers.hpp"

namespace splinecast::ipc {

void RefusalReader::skip(const KnotBoardReader& board) noexcept {
  (void)board.copy_newest_summary(summary_);
  seen_ = summary_.refused;
}

void RefusalReader::restart() noexcept {
  summary_ = {};
  seen_ = 0;
}

void RefusalReader::look(const KnotBoardReader& board, const WaypointRingReader& ring,
                         Refusals& out) {
  (void)board.copy_newest_summary(summary_);
  out.items.clear();
  out.missed = 0;
  out.consumed = summary_.consumed;
  if (summary_.refused <= seen_) return;
  const std::size_t count = board.copy_refusals(summary_, seen_, copied_);
  out.missed = summary_.refused - seen_ - count;
  seen_ = summary_.refused;
  for (const RefusalRecord& refused : std::span(copied_).first(count)) {
    if (refused.item < first_) continue;
    out.items.push_back(
        {.item = refused.item, .time = ring.observe_time(refused.item), .reason = refused.reason});
    if (refused.reason == Refusal::stopped) out.items.back().by = stopper_of(board, refused.slot);
    if (refused.reason != Refusal::beyond_limits) continue;
    out.items.back().excess = board.excess_of(summary_, refused.item);
  }
}

}  // namespace splinecast::ipc
