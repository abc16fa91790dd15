#include "ipc/owned/outcome.hpp"

#include <algorithm>
#include <optional>

#include "ipc/layout/knot_slots.hpp"
#include "ipc/layout/summary.hpp"

namespace splinecast {
namespace ipc {
namespace {

ItemOutcome in_force(Time time, OutcomeWay way, Time settled) noexcept {
  return {.kind = OutcomeKind::in_force, .time = time, .way = way, .is_final = time <= settled};
}

/// The outcome of a refused item; forgotten if it may have been refused by one that the board no
/// longer has; nothing if it was not refused.
std::optional<ItemOutcome> refusal_of(const KnotBoardReader& board, const Summary& summary,
                                      Word item) noexcept {
  Word next = summary.consumed;
  const Word oldest = summary.refused - std::min<Word>(summary.refused, kRefusalsKept);
  for (Word i = summary.refused; i > oldest; --i) {
    const RefusalRecord refused = board.refusal(i - 1);
    if (refused.item >= next) break;  // overwritten, and so are all older ones
    if (refused.item < item) return std::nullopt;
    if (refused.item == item) {
      return ItemOutcome{.kind = OutcomeKind::refused, .reason = refused.reason, .is_final = true};
    }
    next = refused.item;
    if (i == 1) return std::nullopt;
  }
  if (summary.refused == 0) return std::nullopt;
  return ItemOutcome{.kind = OutcomeKind::forgotten};
}

/// The newest record of an item.
std::optional<OutcomeRecord> record_of(const KnotBoardReader& board, const Summary& summary,
                                       Word item) noexcept {
  const Word kept = std::min<Word>(summary.outcomes, kOutcomesKept);
  for (Word back = 1; back <= kept; ++back) {
    const auto record = board.outcome(summary.outcomes - back);
    if (!record) break;  // overwritten, and so are all older ones
    if (record->is_of(item)) return record;
  }
  return std::nullopt;
}

}  // namespace

ItemOutcome outcome_of(const KnotBoardReader& board, const WaypointRingReader& ring,
                       Word item) noexcept {
  // Before the summary: no revision after that one changes what had settled by then.
  const Time settled = board.look().settled_until;
  Summary summary;
  if (!board.copy_newest_summary(summary) || item >= summary.consumed) return {};
  const auto refused = refusal_of(board, summary, item);
  const auto record = record_of(board, summary, item);
  const bool is_in_force = record && record->kind == OutcomeKind::in_force;
  if (is_in_force) return in_force(record->time, record->way, settled);
  if (refused) return *refused;  // also within the range of a record
  if (record) return {.kind = record->kind, .is_final = true};
  const auto time = ring.observe_time(item);
  if (item < board.outcomes_lost() || !time) return {.kind = OutcomeKind::forgotten};
  if (item >= summary.undecided) return {.kind = OutcomeKind::undecided};
  return in_force(*time, OutcomeWay::spline, settled);
}

}  // namespace ipc

std::string_view to_string(OutcomeKind kind) noexcept {
  switch (kind) {
    case OutcomeKind::waiting:
      return "waiting";
    case OutcomeKind::undecided:
      return "undecided";
    case OutcomeKind::in_force:
      return "in force";
    case OutcomeKind::passed_over:
      return "passed over";
    case OutcomeKind::withdrawn:
      return "withdrawn";
    case OutcomeKind::refused:
      return "refused";
    case OutcomeKind::forgotten:
      return "forgotten";
  }
  return "unknown";
}

std::string_view to_string(OutcomeWay way) noexcept {
  switch (way) {
    case OutcomeWay::spline:
      return "spline";
    case OutcomeWay::entry:
      return "entry";
    case OutcomeWay::stop:
      return "stop";
    case OutcomeWay::end:
      return "end";
  }
  return "unknown";
}

std::string to_string(const ItemOutcome& outcome) {
  std::string text(to_string(outcome.kind));
  if (outcome.kind == OutcomeKind::refused)
    return text + ": " + std::string(to_string(outcome.reason));
  if (!outcome.time) return text;
  return text + " at " + std::to_string(outcome.time->count()) +
         " ns: " + std::string(to_string(outcome.way));
}

}  // namespace splinecast
