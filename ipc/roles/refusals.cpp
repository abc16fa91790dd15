#include "ipc/roles/refusals.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <span>

namespace splinecast::ipc {
namespace {

constexpr int kHeadTries = 16;

std::string number(double value) {
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.begin(), text.end(), value, std::chars_format::general, 6);
  return {text.begin(), end.ptr};
}

}  // namespace

std::string to_string(const ItemRefusal& refusal) {
  std::string text = "item " + std::to_string(refusal.item) + " refused: ";
  text += to_string(refusal.reason);
  if (refusal.time) text += " (time " + std::to_string(refusal.time->count()) + " ns)";
  if (refusal.excess) text += ": " + in_words(*refusal.excess);
  return text;
}

std::string in_words(const LimitExcess& excess, std::span<const std::string> names) {
  std::string text(core::to_string(excess.kind));
  text += " of dimension " + std::to_string(excess.dimension);
  const bool has_name = excess.dimension < names.size() && !names[excess.dimension].empty();
  if (has_name) text += " (" + names[excess.dimension] + ")";
  return text + " is " + number(excess.value) + " at " + std::to_string(excess.time.count()) +
         " ns, limit " + number(excess.limit);
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
    if (refused.reason != Refusal::beyond_limits) continue;
    out.items.back().excess = board.excess_of(head_, refused.item);
  }
}

}  // namespace splinecast::ipc
