#include <algorithm>
#include <cmath>

#include "core/forms/entry.hpp"
#include "core/forms/stop.hpp"
#include "core/limits/extremes.hpp"
#include "core/limits/limit_of.hpp"
#include "ipc/solve/published_curve.hpp"

/// Ends a published curve.
namespace splinecast::ipc {
namespace {

bool is_zero(std::span<const double> values) noexcept {
  return std::ranges::all_of(values, [](double value) { return value == 0; });
}

/// Whether a curve rests at a position from a state on, if it stays within `reach` from there.
bool rests_at(const Instant& state, const core::PositionRange& reach,
              std::span<const double> position) noexcept {
  return std::ranges::equal(state.position, position) && is_zero(state.velocity) &&
         is_zero(state.acceleration) && std::ranges::equal(reach.least(), position) &&
         std::ranges::equal(reach.greatest(), position);
}

}  // namespace

/// Ends the curve at the newest waypoint. Requires that it ends with a piece of the target.
void PublishedCurve::finish_on_line(const Condition& end) noexcept {
  const std::size_t knots = window_.knots();
  window_.finish(end);
  finish_ = Ended{EndKind::as_requested};
  has_changes_ = true;
  // A full stop changes the form of the last segment: its left knot is written again.
  open_ = std::min(open_, knots - std::min<std::size_t>(knots, 2));
}

/// Finds the limits of an end. A dimension without a limit of acceleration has the one that the
/// motion has shown.
void PublishedCurve::find_end_limits() noexcept {
  look_at_shown();
  search_.write_accelerations(window_.limits_at_largest_rate(), shown_.limits(),
                              end_limits_.acceleration);
}

/// Whether the curve, ended at the newest waypoint, rests there and keeps the limits: a segment
/// that exceeds one must not exceed it more than without the end. A recorded stream ends as
/// requested.
bool PublishedCurve::keeps_limits_with(const Condition& end, Time settled) noexcept {
  if (!entries_.is_live) return true;
  find_end_limits();
  trial_.begin(window_);
  core::SlidingWindow& ended = trial_.window();
  ended.finish(end);
  return is_zero(ended.knot(ended.knots() - 1).velocity) &&
         trial_.exceeds_no_more(end_limits_, first_open(settled), window_);
}

/// Marks the newest waypoint as met by a curve that does not reach it on the target.
void PublishedCurve::end_at_newest() noexcept {
  const std::size_t last = window_.knots() - 1;
  if (core::is<core::OnTarget>(end_)) unmet_ = last;
  met_ = std::max(unmet_, last);
}

/// Ends the curve with the entry that the search found, which comes to rest at the newest waypoint.
void PublishedCurve::enter_end(const Instant& from) noexcept {
  if (uses_cut_) {
    cut_.write();
    set_origin(cut_.next(), from);
  }
  is_entry_new_ = true;
  finish_ = Ended{EndKind::entered, search_.end().state.time};
  const auto newest = window_.knot(window_.knots() - 1).position;
  std::ranges::copy(newest, beyond_.ref().position.begin());
  note_change(origin_.time);
}

bool PublishedCurve::finish(const Condition& end, Time settled, Time keep, int& tries) noexcept {
  const std::size_t knots = window_.knots();
  if (knots == 0) {  // the curve ends with its current stop
    finish_ = Ended{EndKind::as_requested};
    return true;
  }
  if (is_start_open()) check_start(settled, true);
  const bool is_begun = std::holds_alternative<SearchingEnd>(finish_);
  if (!is_on_line() && !is_begun && has_room_to_enter(keep) && prepare(settled)) {
    enter_before_end();
  }
  if (!is_on_line() || window_.frozen_knots() == knots) return search_end(settled, tries);
  if (keeps_limits_with(end, settled)) {
    finish_on_line(end);
    return true;
  }
  // The search begins in the published curve.
  if (has_changes_) return false;
  const bool has_settled = knots < 2 || window_.time(knots - 2) < settled;
  if (has_settled) return search_end(settled, tries);
  if (!is_begun || is_trying(EndAttempt::slowing)) {
    if (!slow_down(settled, tries)) return false;
    if (ending() != EndKind::none || is_damaged_) return true;
  }
  return search_end_from_knots(settled, tries);
}

/// Searches for the latest knot from which on the curve can slow down on its path. Returns false if
/// the search has not ended.
bool PublishedCurve::slow_down(Time settled, int& tries) noexcept {
  if (!is_trying(EndAttempt::slowing)) {
    finish_ = SearchingEnd{EndAttempt::slowing};
    slowed_.restart(summary_, end_limits_);
  }
  switch (slowed_.search(number_of(met_) + 1, settled, tries)) {
    case SlowedEnd::Outcome::more:
      return false;
    case SlowedEnd::Outcome::found:
      finish_ = Ended{EndKind::slowed};
      note_change(slowed_.begin());
      return true;
    case SlowedEnd::Outcome::damaged:
      is_damaged_ = true;
      return true;
    case SlowedEnd::Outcome::none:
      break;
  }
  return true;
}

/// Searches for the latest knot at which an entry may begin that ends the curve, and that stays
/// within the range of the published curve from that knot to the last waypoint. Without such a knot
/// the curve ends in the shortest stop after its last waypoint. Returns false if the search has not
/// ended.
bool PublishedCurve::search_end_from_knots(Time settled, int& tries) noexcept {
  if (!is_trying(EndAttempt::from_knots)) {
    finish_ = SearchingEnd{EndAttempt::from_knots, window_.knots() - 1};
    search_.restart(0);
    look_at_shown();
  }
  const Instant rest = rest_at_newest();
  for (std::size_t& knot = std::get<SearchingEnd>(finish_).knot; knot > met_; --knot) {
    const Time t = published_->time_hint(number_of(knot - 1));
    if (t < settled) break;
    uses_cut_ = true;
    is_damaged_ = is_damaged_ || !cut_.find(summary_, t);
    if (is_damaged_ || !find_reach(rest.time)) return true;
    const Instant from = begin_state();
    const auto outcome =
        search_.search_rest(rest, from, entry_rules(), core::EntrySearch::kLongest, tries);
    if (outcome == core::EntrySearch::Outcome::more) return false;
    if (outcome == core::EntrySearch::Outcome::found) {
      passed_before_ += passed_over();
      end_ = core::OnTarget{};
      unmet_ = knot;
      enter_end(from);
      met_ = window_.knots() - 1;
      return true;
    }
    search_.restart(0);
  }
  finish_ = Ended{EndKind::stopped};
  has_changes_ = true;
  open_ = std::min(open_, window_.knots() - 1);
  return true;
}

/// Builds the stop after the newest waypoint, in which the curve has been ended: the shortest that
/// keeps the limits of acceleration and jerk at each rate of a law, if any dimension has a limit of
/// acceleration.
void PublishedCurve::stop_behind_newest(core::Segment& out) noexcept {
  const core::Knot knot = window_.knot(window_.knots() - 1);
  const Time usual = window_.write_stop(values_);
  const MotionLimits& given = window_.limits_at_largest_rate();
  const bool has_limit =
      std::ranges::any_of(given.acceleration, [](double limit) { return limit > 0; });
  const Instant from{knot.time, knot.position, knot.velocity, values_};
  const Time shortest = std::max(core::stop_time_within({end_limits_, kinds_, Time(1)}, from),
                                 core::stop_time_within({given, kinds_, Time(1)}, from));
  core::build_stop(knot.time, has_limit ? std::min(usual, shortest) : usual, knot.position,
                   knot.velocity, values_, out);
}

/// The last waypoint as a state at rest. Valid until values_ changes.
Instant PublishedCurve::rest_at_newest() noexcept {
  const core::Knot newest = window_.knot(window_.knots() - 1);
  std::ranges::fill(values_, 0.0);
  return {newest.time, newest.position, values_, values_};
}

/// Finds the state in which an entry to the last waypoint may begin. Returns false if the board is
/// damaged.
bool PublishedCurve::prepare_end(Time settled) noexcept {
  if (!is_trying(EndAttempt::from_rest)) return prepare(settled);
  uses_cut_ = true;
  is_damaged_ = is_damaged_ || !cut_.find(summary_, std::max(settled, rest_));
  return !is_damaged_ && find_reach(Time::max());
}

/// The longest entry from `from` that may end the curve at `rest`. It may last as long as the
/// published curve and, after that, an entry from rest: kLongest, or what the given limits require
/// from where that curve is farthest away. The components of a quaternion count as positions.
Time PublishedCurve::longest_end(const Instant& rest, Time from) const noexcept {
  constexpr double kLongestWithinLimits = 60;  // s
  const MotionLimits& limits = window_.limits_at_largest_rate();
  double seconds = to_seconds(core::EntrySearch::kLongest);
  for (std::size_t d = 0; d < rest.position.size(); ++d) {
    const double x = rest.position[d];
    const double way =
        std::max(std::abs(reach_.least()[d] - x), std::abs(reach_.greatest()[d] - x));
    seconds = std::max(seconds, core::seconds_from_rest(way, core::limit_of(limits.velocity, d),
                                                        core::limit_of(limits.acceleration, d),
                                                        core::limit_of(limits.jerk, d)));
  }
  return std::max(rest_ - from, Time::zero()) +
         from_seconds(std::min(seconds, kLongestWithinLimits));
}

/// Searches for the entry that ends the curve. Returns false if the search has not ended.
bool PublishedCurve::search_end(Time settled, int& tries) noexcept {
  if (!prepare_end(settled)) return true;
  const Instant rest = rest_at_newest();
  for (;;) {
    const Instant from = begin_state();
    if (rests_at(from, reach_, rest.position)) {
      end_at_newest();
      finish_ = Ended{EndKind::as_requested};
      return true;
    }
    const bool is_from_rest = is_trying(EndAttempt::from_rest);
    if (!is_from_rest && !is_trying(EndAttempt::from_settled)) {
      search_.restart(0);
      finish_ = SearchingEnd{EndAttempt::from_settled};
    }
    const auto outcome = search_.search_rest(
        rest, from, entry_rules(),
        is_from_rest ? core::EntrySearch::kLongest : longest_end(rest, from.time), tries);
    if (outcome == core::EntrySearch::Outcome::more) return false;
    if (outcome == core::EntrySearch::Outcome::found) {
      enter_end(from);
      end_at_newest();
      return true;
    }
    if (is_from_rest || from.time >= rest_) {
      finish_ = Ended{EndKind::in_stop};
      return true;
    }
    // The stop of a state that is not committed yet is not on the board.
    finish_ = SearchingEnd{EndAttempt::from_rest};
    search_.restart(0);
    if (origin_.is_new) return false;
    if (!prepare_end(settled)) return true;
  }
}

}  // namespace splinecast::ipc
