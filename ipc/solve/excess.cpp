#include <algorithm>

#include "ipc/solve/published_curve.hpp"

/// Compares a published curve with the limits before a waypoint is taken, and takes waypoints so
/// that the curve keeps them (Beyond::enter).
namespace splinecast::ipc {
namespace {

using Outcome = core::PlanSearch::Outcome;

/// Number of knots before the newest one at which the curve tries to leave its target.
constexpr std::size_t kEarlierKnots = 8;

/// The record of an excess, without its item.
std::optional<LimitExcess> record_of(const std::optional<core::TimedExcess>& found) noexcept {
  if (!found) return std::nullopt;
  const Excess& excess = found->excess;
  return LimitExcess{.kind = excess.kind,
                     .dimension = excess.dimension,
                     .time = found->time,
                     .value = excess.value,
                     .limit = excess.limit};
}

}  // namespace

std::optional<LimitExcess> PublishedCurve::find_excess(const Waypoint& waypoint,
                                                       Time settled) noexcept {
  return record_of(search_.excess_with(plan_, waypoint, settled, begins_stream()));
}

std::optional<LimitExcess> PublishedCurve::stop_excess() noexcept {
  if (!search_.has_limits()) return std::nullopt;
  if (plan_.ending() == EndKind::stopped) {
    search_.build_stop_at_end(plan_, segment_);
  } else if (!read_.take_last(*published_, summary_) || read_.kind() != SegmentKind::stop) {
    return std::nullopt;
  } else {
    segment_.left = read_.left();
    segment_.right = read_.natural_right();
    segment_.order = read_.order();
    segment_.kind = SegmentKind::stop;
    std::ranges::copy(read_.coefficients(), segment_.coefficients.begin());
  }
  return record_of(search_.excess_of_stop(segment_));
}

Followed PublishedCurve::follow(const Waypoint& waypoint, Word item, Time settled, Time keep,
                                int& tries, std::optional<LimitExcess>& excess) noexcept {
  const bool is_unmet = !is_on_target() && plan_.unmet_since() < Time::max();
  if (plan_.has_given_up() || (is_unmet && waypoint.time - plan_.unmet_since() > kUnmetRefused)) {
    return follow_from_rest(waypoint, item, settled, keep, tries);
  }
  if (is_on_target()) excess = excess_with(waypoint, settled);
  if (excess) return leave(waypoint, item, settled, keep, tries);
  append(waypoint, item);
  return Followed::taken;
}

/// Whether the curve may leave its target at leaving_knot_, which it has not passed yet.
bool PublishedCurve::has_room_to_leave(Time settled, Time keep) const noexcept {
  const std::size_t knots = window().knots();
  const std::size_t frozen = window().frozen_knots();
  const std::size_t oldest =
      std::max({plan_.met(), frozen - std::min<std::size_t>(frozen, 1), window().oldest_segment(),
                knots - std::min(knots, kEarlierKnots + 1), std::size_t{1}});
  return leaving_knot_ >= oldest && leaving_knot_ < knots &&
         window().time(leaving_knot_) >= settled && has_room_to_enter(keep);
}

/// Searches for an entry from leaving_knot_ of the committed curve onto the target with a waypoint
/// more, of which only the knots up to that one are frozen.
Outcome PublishedCurve::search_from_knot(const Waypoint& waypoint, int& tries) noexcept {
  const bool is_found = find_cut(window().time(leaving_knot_)) && find_reach(Time::max());
  if (!is_found) return Outcome::none;
  return search_.search_with(plan_, waypoint, leaving_knot_ + 1, entry_begin(), tries);
}

/// Takes a waypoint with which the target exceeds a limit. The entry is searched for before
/// anything is changed: only the knots that the curve meets may be frozen.
Followed PublishedCurve::leave(const Waypoint& waypoint, Word item, Time settled, Time keep,
                               int& tries) noexcept {
  if (has_changes()) return Followed::waits;  // the entry begins in the committed curve
  is_prepared_ = false;
  look_at_shown();
  if (search_.awaits_start_check(plan_) && !search_.keeps_start(plan_, shown())) {
    check_start(settled, true);
    append(waypoint, item);
    return Followed::taken;
  }
  if (leaving_item_ != item) {
    leaving_item_ = item;
    leaving_knot_ = window().knots() - 1;
    search_.restart_at(leaving_knot_ + 1);
  }
  for (; has_room_to_leave(settled, keep); --leaving_knot_) {
    const Outcome outcome = search_from_knot(waypoint, tries);
    if (outcome == Outcome::more) return Followed::waits;
    if (is_damaged_) return Followed::taken;
    if (outcome == Outcome::found) {
      leave_at(leaving_knot_, waypoint, item);
      enter();
      return Followed::taken;
    }
    search_.restart_at(leaving_knot_);
  }
  leave_at(window().knots() - 1, waypoint, item);
  return Followed::taken;
}

/// Ends the curve's way on the target at a knot, and appends a waypoint to the target.
void PublishedCurve::leave_at(std::size_t knot, const Waypoint& waypoint, Word item) noexcept {
  plan_.leave_target_at(knot);
  writer_.left_target(plan_);
  leaving_item_.reset();
  append(waypoint, item);
}

/// Takes a waypoint if an entry that begins where the curve rests can lead to the target at its
/// time or later; else only records that the curve has given up.
Followed PublishedCurve::follow_from_rest(const Waypoint& waypoint, Word item, Time settled,
                                          Time keep, int& tries) noexcept {
  if (has_changes()) return Followed::waits;  // the entry begins in the committed curve
  plan_.set_searching(false);
  is_prepared_ = false;
  const Time rest = writer_.rest();
  const Time until = rest + search_.options().least_entry;
  plan_.give_up_until(until);
  const Time begin = std::max({settled, rest, waypoint.time - core::EntrySearch::kLongest});
  if (waypoint.time <= std::max(until, begin) || !has_room_to_enter(keep)) {
    return Followed::refused;
  }
  if (!find_cut(begin) || !find_reach(Time::max())) return Followed::refused;
  look_at_shown();
  if (leaving_item_ != item) search_.restart_at(window().knots());
  leaving_item_ = item;
  const Outcome outcome = search_.search_with(plan_, waypoint, 0, entry_begin(), tries);
  if (outcome == Outcome::more) return Followed::waits;
  leaving_item_.reset();
  if (outcome == Outcome::none) return Followed::refused;
  append(waypoint, item);
  enter();
  if (!is_on_target()) plan_.resume_at(waypoint.time);
  return Followed::taken;
}

}  // namespace splinecast::ipc
