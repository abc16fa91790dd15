#include "ipc/verification/recorded_decisions.hpp"

#include <algorithm>

#include "ipc/ring/item.hpp"
#include "splinecast/waypoint.hpp"

namespace splinecast::ipc {

bool RecordedDecisions::is_entry(std::size_t i) const noexcept {
  return segments_[i].kind == SegmentKind::entry && segments_[i].origin.item &&
         (segments_[i].origin.ends_at_waypoint || segments_[i].origin.known > 0);
}

bool RecordedDecisions::is_behind_entry(std::size_t i) const noexcept {
  if (i == 0 || segments_[i].has_waypoint || segments_[i].number != before(i).number + 1) {
    return false;
  }
  const bool follows_line = before(i).kind == SegmentKind::spline && !before(i).has_waypoint;
  const bool follows_entry = before(i).kind == SegmentKind::entry && before(i).origin.known > 0;
  return (follows_entry && segments_[i].kind != SegmentKind::entry) ||
         (follows_line && segments_[i].kind == SegmentKind::stop);
}

bool RecordedDecisions::is_ending(std::size_t i) const noexcept {
  return i + 1 == segments_.size() && record_.summary.finished && !is_entry(i) &&
         segments_[i].kind == SegmentKind::entry;
}

bool RecordedDecisions::begins_run(std::size_t i, std::optional<Word> run_item) const noexcept {
  const SegmentCopy& segment = segments_[i];
  if (i == 0) return true;
  if (is_entry(i)) return !run_item || *run_item != *segment.origin.item;
  return segment.kind == SegmentKind::stop && !segment.has_waypoint && !is_behind_entry(i);
}

std::size_t RecordedDecisions::end_of_run(std::size_t i,
                                          std::optional<Word> run_item) const noexcept {
  std::size_t end = i + 1;
  while (end < segments_.size() && !begins_run(end, run_item) && !is_ending(end)) ++end;
  return end;
}

bool RecordedDecisions::begins_at_cut(std::size_t i) const noexcept {
  if (!segments_[i].origin.item) return true;
  Word item = *segments_[i].origin.item;
  while (item > 0 && !record_.items.is_taken(item - 1, ItemKind::replace)) --item;
  return item > 0 && record_.items.waypoint(item - 1).time == segments_[i].left;
}

bool RecordedDecisions::begins_elsewhere(std::size_t i) const noexcept {
  if (segments_[i].has_waypoint) return false;
  const Word items = record_.items.size();
  if (record_.items.find(ItemKind::start_state, 0, items)) return true;
  const auto has_item = [](const SegmentCopy& s) { return s.origin.item.has_value(); };
  const auto entry = std::ranges::find_if(segments_, has_item);
  const Word first = entry != segments_.end() ? *entry->origin.item : items;
  const auto waypoint = record_.items.find(ItemKind::waypoint, 0, first);
  return waypoint && record_.items.find(ItemKind::replace, *waypoint, first).has_value();
}

bool RecordedDecisions::is_last_run(std::optional<Word> run_item) const noexcept {
  return record_.summary.finished && run_item && *run_item + 1 == record_.summary.run_item;
}

}  // namespace splinecast::ipc
