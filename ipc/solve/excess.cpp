#include <algorithm>

#include "ipc/solve/published_curve.hpp"

/// Compares a published curve with the limits before a waypoint is taken, and takes waypoints so
/// that the curve keeps them (Beyond::enter).
namespace splinecast::ipc {
namespace {

using Outcome = core::EntrySearch::Outcome;

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

/// The first segment that is not frozen and that the published curve may still follow. A curve that
/// is not on the target can follow only segments after its next entry, which begins at `settled` or
/// later.
std::size_t PublishedCurve::first_open(Time settled) const noexcept {
  const std::size_t frozen = window_.frozen_knots();
  std::size_t first =
      std::max({is_on_line() ? met_ : unmet_, frozen - std::min<std::size_t>(frozen, 1),
                window_.oldest_segment()});
  if (is_on_line()) return first;
  const Time begin = origin_.number > 0 ? std::max(settled, origin_.time) : settled;
  const Time earliest = std::max(begin + entries_.min_entry, blend_until_);
  while (first < window_.knots() && window_.time(first) < earliest) ++first;
  return first;
}

/// The first segment to be compared when a waypoint is appended. Excludes the first kStartFades
/// segments of a stream that starts at rest: check_start() compares them with the limits. On a live
/// stream they are compared after that, unless an entry from rest may still pass over them.
std::size_t PublishedCurve::first_compared(Time settled) const noexcept {
  const bool is_undecided = awaits_start_check() || (window_.knots() < 2 && !entries_.keeps_limits);
  const bool may_pass_over = is_undecided || (!is_on_line() && origin_.number == 1);
  const bool excludes_start = starts_from_halt() && (!entries_.is_live || may_pass_over);
  return std::max(first_open(settled), excludes_start ? core::kStartFades : 0);
}

std::optional<LimitExcess> PublishedCurve::find_excess(const Waypoint& waypoint,
                                                       Time settled) noexcept {
  trial_.begin(window_);
  trial_.window().append(waypoint);
  const bool all_count = entries_.keeps_limits;
  const auto worst = trial_.worst_excess(first_compared(settled), all_count ? nullptr : &window_);
  if (worst || !entries_.checks_stops) return record_of(worst);
  const auto excess = trial_.excess_of_newest_stop();
  return excess && excess->time >= settled ? record_of(excess) : std::nullopt;
}

std::optional<LimitExcess> PublishedCurve::stop_excess() noexcept {
  if (!has_limits_) return std::nullopt;
  if (ending() == EndKind::stopped) {
    stop_behind_newest(segment_);
  } else if (!read_.take_last(*published_, summary_) || read_.kind() != SegmentKind::stop) {
    return std::nullopt;
  } else {
    segment_.left = read_.left();
    segment_.right = read_.natural_right();
    segment_.order = read_.order();
    segment_.kind = SegmentKind::stop;
    std::ranges::copy(read_.coefficients(), segment_.coefficients.begin());
  }
  return record_of(trial_.excess_of_stop(segment_, false));
}

/// Whether check_start() still has to compare the first segments with the limits.
bool PublishedCurve::awaits_start_check() const noexcept {
  return is_start_open() && window_.knots() < window_.options().settle + 2;
}

Followed PublishedCurve::follow(const Waypoint& waypoint, Word item, Time settled, Time keep,
                                int& tries, std::optional<LimitExcess>& excess) noexcept {
  const bool is_unmet = !is_on_line() && unmet_since_ < Time::max();
  if (has_given_up() || (is_unmet && waypoint.time - unmet_since_ > kUnmetRefused)) {
    return follow_from_rest(waypoint, item, settled, keep, tries);
  }
  if (is_on_line()) excess = excess_with(waypoint, settled);
  if (excess) return leave(waypoint, item, settled, keep, tries);
  append(waypoint, item);
  return Followed::taken;
}

/// Whether the curve may leave its target at leaving_knot_, which it has not passed yet.
bool PublishedCurve::has_room_to_leave(Time settled, Time keep) const noexcept {
  const std::size_t knots = window_.knots();
  const std::size_t frozen = window_.frozen_knots();
  const std::size_t oldest =
      std::max({met_, frozen - std::min<std::size_t>(frozen, 1), window_.oldest_segment(),
                knots - std::min(knots, kEarlierKnots + 1), std::size_t{1}});
  return leaving_knot_ >= oldest && leaving_knot_ < knots &&
         window_.time(leaving_knot_) >= settled && has_room_to_enter(keep);
}

/// Searches for an entry from leaving_knot_ of the committed curve onto the target with a waypoint
/// more, of which only the knots up to that one are frozen.
Outcome PublishedCurve::search_from_knot(const Waypoint& waypoint, int& tries) noexcept {
  uses_cut_ = true;
  is_damaged_ = is_damaged_ || !cut_.find(summary_, window_.time(leaving_knot_));
  if (is_damaged_ || !find_reach(Time::max())) return Outcome::none;
  trial_.begin(window_);
  trial_.window().freeze_knots(leaving_knot_ + 1);
  trial_.window().append(waypoint);
  core::EntryRules rules = entry_rules();
  rules.goes_beyond = true;
  return search_.search(trial_.window(), begin_state(), rules, tries);
}

/// Takes a waypoint with which the target exceeds a limit. The entry is searched for before
/// anything is changed: verification freezes the knots that the curve meets, and no others.
Followed PublishedCurve::leave(const Waypoint& waypoint, Word item, Time settled, Time keep,
                               int& tries) noexcept {
  if (has_changes_) return Followed::waits;  // the entry begins in the committed curve
  is_prepared_ = false;
  look_at_shown();
  if (awaits_start_check() && !search_.keeps_start(window_, entry_rules())) {
    append(waypoint, item);
    check_start(settled, true);
    return Followed::taken;
  }
  if (leaving_item_ != item) {
    leaving_item_ = item;
    leaving_knot_ = window_.knots() - 1;
    search_.restart(leaving_knot_ + 1);
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
    search_.restart(leaving_knot_);
  }
  leave_at(window_.knots() - 1, waypoint, item);
  return Followed::taken;
}

/// Ends the curve's way on the target at a knot, and appends a waypoint to the target.
void PublishedCurve::leave_at(std::size_t knot, const Waypoint& waypoint, Word item) noexcept {
  passed_before_ += passed_over();
  window_.freeze_knots(knot + 1);
  wait_for_entry(knot + 1);
  leaving_item_.reset();
  append(waypoint, item);
}

/// Takes a waypoint if an entry that begins where the curve rests can lead to the target at its
/// time or later; else the plan stays as it is.
Followed PublishedCurve::follow_from_rest(const Waypoint& waypoint, Word item, Time settled,
                                          Time keep, int& tries) noexcept {
  if (has_changes_) return Followed::waits;  // the entry begins in the committed curve
  core::set_searching(end_, false);
  is_prepared_ = false;
  refused_until_ = rest_ + entries_.min_entry;
  const Time begin = std::max({settled, rest_, waypoint.time - core::EntrySearch::kLongest});
  if (waypoint.time <= std::max(refused_until_, begin) || !has_room_to_enter(keep)) {
    return Followed::refused;
  }
  uses_cut_ = true;
  is_damaged_ = is_damaged_ || !cut_.find(summary_, begin);
  if (is_damaged_ || !find_reach(Time::max())) return Followed::refused;
  look_at_shown();
  trial_.begin(window_);
  trial_.window().append(waypoint);
  if (leaving_item_ != item) search_.restart(trial_.window().knots() - 1);
  leaving_item_ = item;
  core::EntryRules rules = entry_rules();
  rules.goes_beyond = true;
  const Outcome outcome = search_.search(trial_.window(), begin_state(), rules, tries);
  if (outcome == Outcome::more) return Followed::waits;
  leaving_item_.reset();
  if (outcome == Outcome::none) return Followed::refused;
  append(waypoint, item);
  enter();
  refused_until_ = Time::max();
  unmet_since_ = waypoint.time;
  return Followed::taken;
}

}  // namespace splinecast::ipc
