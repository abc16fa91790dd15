#include "ipc/verification/run_target.hpp"

#include <algorithm>

#include "core/laws/law_path.hpp"
#include "ipc/ring/item.hpp"
#include "splinecast/waypoint.hpp"

namespace splinecast::ipc {

void RunTarget::forget_waypoints() noexcept {
  waypoints_.clear();
  first_ = 0;
  met_.clear();
  frozen_met_ = 0;
}

void RunTarget::list_waypoints(Word first) {
  waypoints_.clear();
  first_ = 0;
  if (!record_.items.is_taken(first, ItemKind::rate)) return list_after(first, std::nullopt);
  const Instant begin = plan_.origin();
  list_plan(first,
            {.time = begin.time,
             .position = begin.position[0],
             .rate = begin.velocity[0],
             .slope = begin.acceleration[0]},
            0);
}

/// Lists the waypoints of the plan of a law whose pieces begin with item `first`, from its waypoint
/// `done` on. `from`: the state before that one.
void RunTarget::list_plan(Word first, const core::LawState& from, std::size_t done) {
  if (!is_time_in_range(from.time)) return;
  const SentItems& items = record_.items;
  const std::size_t pieces =
      std::min<std::size_t>(std::size_t{1} + items.count(first), core::RateCurve::kMostPieces);
  core::LawPath path(from);
  for (std::size_t k = done; k <= pieces; ++k) {
    const Word item = first + std::min(k, pieces - 1);
    if (!items.is_taken(item, ItemKind::rate)) return;
    const auto piece = piece_of(items.waypoint(item));
    if (!piece) return;
    if (k < pieces) {
      path.add_piece(piece->end_rate, piece->length);
    } else {
      path.add_line();
    }
    const Waypoint& waypoint = path.waypoints().back();
    waypoints_.push_back(
        {.time = waypoint.time,
         .item = item,
         .of_plan = {waypoint.position[0], waypoint.velocity[0], waypoint.acceleration[0]}});
  }
}

/// Lists the waypoints from item `first` on that are later than `after`, up to the next replacement
/// or to a waypoint that is not later than the one before it.
void RunTarget::list_after(Word first, std::optional<Time> after) {
  const Word items = record_.items.size();
  const Word replaced = replacements_.find(first, items).value_or(items);
  for (Word item = first;;) {
    const auto next = record_.items.find(ItemKind::waypoint, item, replaced);
    if (!next) return;
    item = *next + 1;
    const Time time = record_.items.waypoint(*next).time;
    if (after && time <= *after) continue;
    after.reset();
    if (!waypoints_.empty() && time <= waypoints_.back().time) return;
    if (!is_time_in_range(time) || !window().takes(record_.items.waypoint(*next))) return;
    waypoints_.push_back({.time = time, .item = *next});
  }
}

void RunTarget::restart(const RunRestart& restart) {
  std::vector<core::Knot> knots;
  for (const RestartKnot& knot : restart.knots) knots.push_back(knot.view());
  plan_.restore(
      {.knots = restart.end(), .frozen = restart.end(), .is_later_run = restart.is_later_run},
      knots);
  forget_waypoints();
  first_ = restart.end() - 1;
  waypoints_.push_back({.time = restart.knots.back().time, .item = restart.run_item});
  if (record_.items.is_taken(restart.run_item, ItemKind::rate)) {
    const RestartKnot& last = restart.knots.back();
    list_plan(
        restart.run_item,
        {.time = last.time, .position = last.waypoint[0], .rate = last.velocity[0], .slope = 0},
        restart.end());
  } else {
    list_after(restart.run_item, restart.knots.back().time);
  }
  used_ = waypoints_.size() > 1 ? waypoints_[1].item : record_.items.size();
}

std::optional<std::size_t> RunTarget::index_of(Time time) const noexcept {
  const auto at = std::ranges::lower_bound(waypoints_, time, {}, &RunWaypoint::time);
  if (at == waypoints_.end() || at->time != time) return std::nullopt;
  return first_ + static_cast<std::size_t>(at - waypoints_.begin());
}

void RunTarget::note_met(std::size_t index, std::size_t newer) {
  if (met_.empty() || met_.back().index < index) met_.push_back({index, 0});
  // The knot between two segments is recorded twice: as a right end and as a left end.
  if (met_.back().index == index) met_.back().newest = index + newer;
}

std::optional<std::size_t> RunTarget::newest_of(std::size_t index) const noexcept {
  const auto at = std::ranges::lower_bound(met_, index, {}, &MetKnot::index);
  if (at == met_.end() || at->index != index) return std::nullopt;
  return at->newest;
}

bool RunTarget::append_until(std::size_t count) {
  while (window().knots() < count) {
    const std::size_t k = window().knots();
    if (k < first_ || k - first_ >= waypoints_.size() || window().finished()) return false;
    for (; frozen_met_ < met_.size() && met_[frozen_met_].newest < k; ++frozen_met_) {
      plan_.freeze_knots(met_[frozen_met_].index + 1);
    }
    (void)plan_.append(plan_.nearest(sent(waypoints_[k - first_])));
    used_ = waypoints_[k - first_].item + 1;
  }
  return true;
}

void RunTarget::finish_last_run() noexcept {
  const EndKind end = record_.summary.ending();
  if (end != EndKind::none && end != EndKind::as_requested) return;
  if (window().knots() != record_.summary.run_knots || window().finished()) return;
  plan_.freeze_knots(record_.summary.run_frozen);
  if (window().frozen_knots() < window().knots()) plan_.end_on_target(record_.end);
}

/// A waypoint of the run as it was sent, or as the plan of a law determines it.
Waypoint RunTarget::sent(const RunWaypoint& waypoint) const noexcept {
  if (!record_.items.is_taken(waypoint.item, ItemKind::rate)) {
    return record_.items.waypoint(waypoint.item);
  }
  const auto values = std::span<const double>(waypoint.of_plan);
  return {.time = waypoint.time,
          .position = values.first(1),
          .velocity = values.subspan(1, 1),
          .acceleration = values.last(1)};
}

}  // namespace splinecast::ipc
