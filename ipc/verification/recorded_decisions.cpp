#include "ipc/verification/recorded_decisions.hpp"

#include <algorithm>
#include <iterator>

#include "ipc/ring/item.hpp"
#include "ipc/runs/run_edges.hpp"
#include "splinecast/waypoint.hpp"

namespace splinecast::ipc {
namespace {

bool is_after(const SegmentCopy& before, const SegmentCopy& segment) noexcept {
  if (segment.has_waypoint || segment.number != before.number + 1) return false;
  const bool follows_line = before.kind == SegmentKind::spline && !before.has_waypoint;
  const bool follows_entry = before.kind == SegmentKind::entry && before.origin.known > 0;
  return (follows_entry && segment.kind != SegmentKind::entry) ||
         (follows_line && segment.kind == SegmentKind::stop);
}

}  // namespace

bool is_entry(const SegmentCopy& segment) noexcept {
  return segment.kind == SegmentKind::entry && segment.origin.item &&
         (segment.origin.ends_at_waypoint || segment.origin.known > 0);
}

bool begins_run(const SegmentCopy& before, const SegmentCopy& segment,
                std::optional<Word> run_item) noexcept {
  if (is_entry(segment)) return !run_item || *run_item != *segment.origin.item;
  return segment.kind == SegmentKind::stop && !segment.has_waypoint && !is_after(before, segment);
}

Replacements::Replacements(const StreamRecord& record) : items_(record.items) {
  for (const SegmentCopy& segment : record.segments) {
    const Word stopped_by = segment.origin.stopped_by;
    if (stopped_by > 0) stops_.push_back({stop_origin(stopped_by).items, segment.left});
  }
  // A record of another program may have them in any order.
  std::ranges::stable_sort(stops_, {}, &Stop::before);
}

std::optional<Word> Replacements::find(Word from, Word end) const noexcept {
  const auto item = items_.find(ItemKind::replace, from, end);
  const auto stop = std::ranges::upper_bound(stops_, from, {}, &Stop::before);
  if (stop == stops_.end() || stop->before > end) return item;
  return std::min(stop->before, item.value_or(stop->before));
}

std::optional<Time> Replacements::time_before(Word end) const noexcept {
  Word item = std::min(end, items_.size());
  while (item > items_.first() && !items_.is_taken(item - 1, ItemKind::replace)) --item;
  const auto after = std::ranges::upper_bound(stops_, end, {}, &Stop::before);
  const bool is_stop = after != stops_.begin() && std::prev(after)->before >= item;
  if (is_stop) return std::prev(after)->time;
  return item > items_.first() ? std::optional(items_.waypoint(item - 1).time) : std::nullopt;
}

bool RecordedDecisions::is_after_entry(std::size_t i) const noexcept {
  return i > 0 && is_after(before(i), segments_[i]);
}

bool RecordedDecisions::is_ending(std::size_t i) const noexcept {
  return i + 1 == segments_.size() && record_.summary.finished && !is_entry(i) &&
         segments_[i].kind == SegmentKind::entry;
}

bool RecordedDecisions::begins_run(std::size_t i, std::optional<Word> run_item) const noexcept {
  return i == 0 || ipc::begins_run(before(i), segments_[i], run_item);
}

std::size_t RecordedDecisions::end_of_run(std::size_t i,
                                          std::optional<Word> run_item) const noexcept {
  std::size_t end = i + 1;
  while (end < segments_.size() && !begins_run(end, run_item) && !is_ending(end)) ++end;
  return end;
}

/// The time of the last replacement before the waypoints of the run that begins with segment i.
std::optional<Time> RecordedDecisions::replaced_from(std::size_t i) const noexcept {
  return replacements_.time_before(*segments_[i].origin.item);
}

bool RecordedDecisions::begins_at_cut(std::size_t i) const noexcept {
  if (!segments_[i].origin.item || segments_[i].is_corner) return true;
  return replaced_from(i) == segments_[i].left;
}

bool RecordedDecisions::may_begin_at_late_cut(std::size_t i) const noexcept {
  const auto from = segments_[i].origin.item ? replaced_from(i) : std::nullopt;
  return from && *from < segments_[i].left;
}

bool RecordedDecisions::begins_elsewhere(std::size_t i) const noexcept {
  if (segments_[i].has_waypoint) return false;
  const Word items = record_.items.size();
  if (record_.items.find(ItemKind::start_state, 0, items)) return true;
  // Or where an earlier stream has left the machine, if a stopper's hold refused what came first. A
  // stream that starts by an entry from its first waypoint begins at the time of that.
  const auto taken = record_.items.find(ItemKind::waypoint, 0, items);
  if (taken && record_.items.waypoint(*taken).time > segments_[i].left) return true;
  const auto has_item = [](const SegmentCopy& s) { return s.origin.item.has_value(); };
  const auto entry = std::ranges::find_if(segments_, has_item);
  const Word first = entry != segments_.end() ? *entry->origin.item : items;
  const auto waypoint = record_.items.find(ItemKind::waypoint, 0, first);
  return waypoint && replacements_.find(*waypoint, first).has_value();
}

bool RecordedDecisions::is_last_run(std::optional<Word> run_item) const noexcept {
  return record_.summary.finished && run_item && *run_item + 1 == record_.summary.run_item;
}

bool RunStarts::take(const SegmentCopy* before, const SegmentCopy& segment) noexcept {
  if (before == nullptr) {
    const bool is_first = segment.number == 1;
    run_item_ = is_first && is_entry(segment) ? segment.origin.item : std::nullopt;
    has_waypoints_ = is_first && (run_item_ || segment.has_waypoint);
    return false;
  }
  if (!begins_run(*before, segment, run_item_)) return false;
  // The first run may have begun without an entry: then its first item is unknown here, but an
  // entry onto it has the item of that run's first waypoint.
  const bool is_new = is_entry(segment) && has_waypoints_ && run_item_;
  run_item_ = is_entry(segment) ? segment.origin.item : std::nullopt;
  has_waypoints_ = run_item_.has_value();
  return is_new;
}

void RunStarts::continue_run(Word run_item) noexcept {
  run_item_ = run_item;
  has_waypoints_ = true;
}

}  // namespace splinecast::ipc
