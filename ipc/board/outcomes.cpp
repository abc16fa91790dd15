#include <algorithm>
#include <optional>

#include "ipc/board/outcome_record.hpp"
#include "ipc/board/reader.hpp"
#include "ipc/board/writer.hpp"

namespace splinecast::ipc {
namespace {

constexpr unsigned kItemShift = 16;
constexpr unsigned kCycleShift = 8;
constexpr Word kByteMask = 0xff;

/// Kinds of a record; 1 to 4: in force, by way 0 to 3.
constexpr Word kPassedOver = 5;
constexpr Word kWithdrawn = 6;

Word code_of(const OutcomeRecord& record) noexcept {
  if (record.kind == OutcomeKind::passed_over) return kPassedOver;
  if (record.kind == OutcomeKind::withdrawn) return kWithdrawn;
  return 1 + static_cast<Word>(record.way);
}

Word cycle_of(Word index) noexcept { return index / kOutcomesKept & kByteMask; }

}  // namespace

void KnotBoardWriter::lose_outcomes(Word end) noexcept {
  Word& lost = control_[kOutcomesLost];
  if (end > load(lost, std::memory_order_relaxed)) store(lost, end, std::memory_order_release);
}

void KnotBoardWriter::write_outcome(Word index, const OutcomeRecord& record) noexcept {
  const auto words = outcomes_.subspan(index % kOutcomesKept * kOutcomeWords, kOutcomeWords);
  const Word old = load(words[0], std::memory_order_relaxed);
  if (index >= kOutcomesKept) lose_outcomes((old >> kItemShift) + 1);
  const bool has_time = record.kind == OutcomeKind::in_force;
  store(words[0], 0, std::memory_order_release);
  store(words[1], has_time ? to_word(record.time) : record.first, std::memory_order_release);
  store(words[0], record.item << kItemShift | cycle_of(index) << kCycleShift | code_of(record),
        std::memory_order_release);
}

std::optional<OutcomeRecord> KnotBoardReader::outcome(Word index) const noexcept {
  const auto words = outcomes_.subspan(index % kOutcomesKept * kOutcomeWords, kOutcomeWords);
  const Word tag = load(words[0], std::memory_order_acquire);
  const Word value = load(words[1], std::memory_order_acquire);
  const Word code = tag & kByteMask;
  const bool is_whole = load(words[0], std::memory_order_relaxed) == tag;
  const bool is_of_index = (tag >> kCycleShift & kByteMask) == cycle_of(index);
  if (!is_whole || !is_of_index || code == 0 || code > kWithdrawn) return std::nullopt;
  const Word item = tag >> kItemShift;
  if (code >= kPassedOver) {
    const auto kind = code == kPassedOver ? OutcomeKind::passed_over : OutcomeKind::withdrawn;
    return OutcomeRecord{.item = item, .kind = kind, .first = value};
  }
  return OutcomeRecord{.item = item,
                       .kind = OutcomeKind::in_force,
                       .way = static_cast<OutcomeWay>(code - 1),
                       .time = to_time(value),
                       .first = item};
}

}  // namespace splinecast::ipc
