#include <algorithm>
#include <array>
#include <optional>

#include "ipc/board/reader.hpp"
#include "ipc/board/writer.hpp"
#include "splinecast/dimension_kind.hpp"

namespace splinecast::ipc {
namespace {

constexpr unsigned kRefusalItemShift = 8;
constexpr Word kByteMask = 0xff;
/// The last byte of a refusal as `stopped`, plus the stopper's slot.
constexpr Word kStoppedBySlot = 128;
/// The word of a lost refusal: its item number is above that of every item, so that readers stop
/// there. 0 would be a refusal of item 0.
constexpr Word kLostRefusal = ~Word{0};

/// Whether a record of `item`, in the place of excess `index` that `summary` counts, belongs to a
/// revision after that summary. Such a revision consumes the items of its excesses. Only the excess
/// of a stop may be of the last item that the summary has consumed. A later record is in the place
/// of one of the oldest excesses that the summary counts, an earlier one of that item in the place
/// of one of the newest: an item has only a few records.
bool is_later_excess(Word item, const Summary& summary, Word index) noexcept {
  const bool is_old_place = summary.exceeding - index > kExcessesKept / 2;
  return item + (is_old_place ? 1 : 0) >= summary.consumed;
}

/// Stores an excess. Word 0 comes last, and is 0 meanwhile.
void put_excess(const LimitExcess& excess, std::span<Word> words) noexcept {
  const std::array values{to_word(excess.time), to_word(excess.value), to_word(excess.limit)};
  store(words[0], 0, std::memory_order_release);
  for (std::size_t i = 0; i < values.size(); ++i) {
    store(words[i + 1], values[i], std::memory_order_release);
  }
  store(words[0],
        excess.item << kExcessItemShift | excess.dimension << kExcessDimensionShift |
            static_cast<Word>(excess.kind) << 1U | (excess.is_refused ? 1 : 0),
        std::memory_order_release);
}

/// Copies an excess; empty before one has been written, and while one is being written.
std::optional<LimitExcess> copy_excess(std::span<const Word> words) noexcept {
  const Word tag = load(words[0], std::memory_order_acquire);
  constexpr Word kKindMask = 7;
  constexpr Word kDimensionMask = kMaxDimensions - 1;
  const LimitExcess found{.item = tag >> kExcessItemShift,
                          .is_refused = (tag & 1U) != 0,
                          .kind = static_cast<LimitKind>((tag >> 1U & kKindMask) % kLimitKinds),
                          .dimension = tag >> kExcessDimensionShift & kDimensionMask,
                          .time = to_time(load(words[1], std::memory_order_acquire)),
                          .value = to_double(load(words[2], std::memory_order_acquire)),
                          .limit = to_double(load(words[3], std::memory_order_acquire))};
  const bool is_whole = tag != 0 && load(words[0], std::memory_order_relaxed) == tag;
  return is_whole ? std::optional(found) : std::nullopt;
}

}  // namespace

void KnotBoardWriter::write_refusal(Word index, const RefusalRecord& refusal) noexcept {
  // One word, so that it is never torn; published by the commit of the summary that counts it.
  const bool is_stopped = refusal.reason == Refusal::stopped;
  const Word reason =
      is_stopped ? kStoppedBySlot + refusal.slot : static_cast<Word>(refusal.reason);
  put(refusals_[index % kRefusalsKept], refusal.item << kRefusalItemShift | reason);
}

void KnotBoardWriter::write_excess(Word index, const LimitExcess& excess) noexcept {
  put_excess(excess, excesses_.subspan(index % kExcessesKept * kExcessWords, kExcessWords));
}

void KnotBoardWriter::write_worst_excess(const LimitExcess& excess) noexcept {
  put_excess(excess, worst_);
}

/// Clears the lost records. They are in the places of the oldest records that the summary counts,
/// in their order; a writer that died here has cleared the first of them. The other places belong
/// to numbers that are written before a summary counts them.
void KnotBoardWriter::clear_lost_records() noexcept {
  const Summary summary = committed_summary();
  const Word refused = summary.refused;
  for (Word i = refused - std::min<Word>(refused, kRefusalsKept); i < refused; ++i) {
    Word& word = refusals_[i % kRefusalsKept];
    const Word found = load(word, std::memory_order_relaxed);
    if (found >> kRefusalItemShift < summary.consumed) break;  // committed, and so are newer ones
    if (found != kLostRefusal) put(word, kLostRefusal);
  }
  const Word exceeding = summary.exceeding;
  for (Word i = exceeding - std::min<Word>(exceeding, kExcessesKept); i < exceeding; ++i) {
    Word& head = excesses_[i % kExcessesKept * kExcessWords];
    const Word found = load(head, std::memory_order_relaxed);
    if (found == 0) continue;  // cleared, or not completed
    if (!is_later_excess(found >> kExcessItemShift, summary, i)) break;
    put(head, 0);
  }
}

RefusalRecord KnotBoardReader::refusal(Word index) const noexcept {
  const Word word = load(refusals_[index % kRefusalsKept], std::memory_order_acquire);
  const Word item = word >> kRefusalItemShift;
  const Word reason = word & kByteMask;
  if (reason < kStoppedBySlot) return {.item = item, .reason = static_cast<Refusal>(reason)};
  return {.item = item,
          .reason = Refusal::stopped,
          .slot = static_cast<std::uint8_t>(reason % kMostStoppers)};
}

std::size_t KnotBoardReader::copy_refusals(const Summary& summary, Word from,
                                           std::span<RefusalRecord> out) const noexcept {
  const Word wanted = summary.refused - std::min(from, summary.refused);
  const auto most = std::min<Word>({wanted, kRefusalsKept, out.size()});
  Word next = summary.consumed;  // the refusal's item must be before this one
  std::size_t count = 0;
  for (; count < most; ++count) {
    const RefusalRecord item = refusal(summary.refused - 1 - count);
    if (item.item >= next) break;  // overwritten, and so are all older ones
    next = item.item;
    out[count] = item;
  }
  std::ranges::reverse(out.first(count));
  return count;
}

std::optional<LimitExcess> KnotBoardReader::excess(const Summary& summary,
                                                   Word index) const noexcept {
  if (index >= summary.exceeding || summary.exceeding - index > kExcessesKept) return std::nullopt;
  const auto words = excesses_.subspan(index % kExcessesKept * kExcessWords, kExcessWords);
  const auto found = copy_excess(words);
  return found && !is_later_excess(found->item, summary, index) ? found : std::nullopt;
}

std::optional<LimitExcess> KnotBoardReader::worst_excess() const noexcept {
  return copy_excess(worst_);
}

std::optional<LimitExcess> KnotBoardReader::excess_of(const Summary& summary,
                                                      Word item) const noexcept {
  const Word kept = std::min<Word>(summary.exceeding, kExcessesKept);
  for (Word back = 1; back <= kept; ++back) {
    const auto found = excess(summary, summary.exceeding - back);
    if (found && found->item == item) return found;
  }
  return std::nullopt;
}

}  // namespace splinecast::ipc
