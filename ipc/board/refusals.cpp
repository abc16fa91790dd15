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
  return found && found->item < summary.consumed ? found : std::nullopt;
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
