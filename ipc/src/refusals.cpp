#include "splinecast/ipc/refusals.hpp"

#include <algorithm>
#include <span>

namespace splinecast::ipc {
namespace {

constexpr int kHeadTries = 16;

}  // namespace

std::string to_string(const ItemRefusal& refusal) {
  std::string text = "item " + std::to_string(refusal.item) + " refused: ";
  text += to_string(refusal.reason);
  if (refusal.time) text += " (time " + std::to_string(refusal.time->count()) + " ns)";
  return text;
}

void RefusalReader::skip(const KnotBoardReader& board) noexcept {
  copy_head(board);
  seen_ = head_.refused;
}

void RefusalReader::restart() noexcept {
  head_ = {};
  seen_ = 0;
}

void RefusalReader::copy_head(const KnotBoardReader& board) noexcept {
  for (int attempt = 0; attempt < kHeadTries; ++attempt) {
    const Look look = board.look();
    if (look.revision == head_.revision || board.copy_head(look, head_)) return;
  }
}

void RefusalReader::look(const KnotBoardReader& board, const WaypointRingReader& ring,
                         Refusals& out) {
  copy_head(board);
  out.items.clear();
  out.missed = 0;
  out.consumed = head_.consumed;
  if (head_.refused <= seen_) return;
  const std::size_t count = board.copy_refusals(head_, seen_, copied_);
  out.missed = head_.refused - seen_ - count;
  seen_ = head_.refused;
  for (const RefusedItem& refused : std::span(copied_).first(count)) {
    if (refused.item < first_) continue;
    out.items.push_back(
        {.item = refused.item, .time = ring.observe_time(refused.item), .reason = refused.reason});
  }
}

}  // namespace splinecast::ipc
