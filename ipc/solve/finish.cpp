#include <algorithm>

#include "ipc/solve/published_curve.hpp"

/// Ends a published curve.
namespace splinecast::ipc {

using Outcome = core::PlanSearch::Outcome;

bool PublishedCurve::finish(const Condition& end, Time settled, Time keep, int& tries) noexcept {
  const std::size_t knots = window().knots();
  if (knots == 0) {  // the curve ends with its current stop
    plan_.end_as({EndKind::as_requested});
    return true;
  }
  if (plan_.is_start_open()) check_start(settled, true);
  const bool is_begun = end_search_.has_value();
  if (!is_on_target() && !is_begun && has_room_to_enter(keep) && prepare(settled) &&
      search_.search_before_end(plan_, entry_begin())) {
    enter();
  }
  if (!is_on_target() || window().frozen_knots() == knots) return search_end(settled, tries);
  look_at_shown();
  if (search_.keeps_limits_with(plan_, end, settled, shown_.limits())) {
    plan_.end_on_target(end);
    writer_.ended_on_target(plan_);
    return true;
  }
  // The search begins in the published curve.
  if (has_changes()) return false;
  const bool has_settled = knots < 2 || window().time(knots - 2) < settled;
  if (has_settled) return search_end(settled, tries);
  if (!is_begun || is_trying(EndAttempt::slowing)) {
    if (!slow_down(settled, tries)) return false;
    if (plan_.ended() || is_damaged_) return true;
  }
  return search_end_from_knots(settled, tries);
}

/// Searches for the latest knot from which on the curve can slow down on its path. Returns false if
/// the search has not ended.
bool PublishedCurve::slow_down(Time settled, int& tries) noexcept {
  if (!is_trying(EndAttempt::slowing)) {
    end_search_ = EndSearch{EndAttempt::slowing};
    slowed_.restart(summary_, search_.end_limits());
  }
  switch (slowed_.search(writer_.number_of(plan_, plan_.met()) + 1, settled, tries)) {
    case SlowedEnd::Outcome::more:
      return false;
    case SlowedEnd::Outcome::found:
      plan_.end_as({EndKind::slowed, slowed_.end()});
      writer_.slowed_from(slowed_.begin());
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
    end_search_ = EndSearch{EndAttempt::from_knots, window().knots() - 1};
    search_.restart_at(0);
    look_at_shown();
  }
  for (std::size_t& knot = end_search_->knot; knot > plan_.met(); --knot) {
    const Time t = published_->time_hint(writer_.number_of(plan_, knot - 1));
    if (t < settled) break;
    if (--tries < 0) return false;  // a candidate that cannot pass costs no try, but its reach does
    if (!find_cut(t) || !find_reach(plan_.newest_time())) return true;
    const Instant from = begin_state();
    const auto outcome =
        search_.search_rest(plan_, entry_begin(), core::EntrySearch::kLongest, tries);
    if (outcome == Outcome::more) return false;
    if (outcome == Outcome::found) {
      cut_.write();
      plan_.end_by_entry_from_target(search_.end().state.time, from, knot);
      writer_.ended_by_entry(plan_, cut_.next());
      return true;
    }
    search_.restart_at(0);
  }
  search_.build_stop_at_end(plan_, segment_);
  plan_.end_as({EndKind::stopped, segment_.right});
  writer_.ended_in_stop(plan_);
  return true;
}

/// Finds the state in which an entry to the last waypoint may begin. Returns false if the board is
/// damaged.
bool PublishedCurve::prepare_end(Time settled) noexcept {
  if (!is_trying(EndAttempt::from_rest)) return prepare(settled);
  return find_cut(std::max(settled, writer_.rest())) && find_reach(Time::max());
}

/// Searches for the entry that ends the curve. Returns false if the search has not ended.
bool PublishedCurve::search_end(Time settled, int& tries) noexcept {
  if (!prepare_end(settled)) return true;
  for (;;) {
    const Instant from = begin_state();
    if (search_.rests_at_newest(plan_, from)) {
      plan_.end_at_newest();
      return true;
    }
    const bool is_from_rest = is_trying(EndAttempt::from_rest);
    if (!is_from_rest && !is_trying(EndAttempt::from_settled)) {
      search_.restart_at(0);
      end_search_ = EndSearch{EndAttempt::from_settled};
    }
    const Time longest = is_from_rest ? core::EntrySearch::kLongest
                                      : search_.longest_end(plan_, from.time, writer_.rest());
    const auto outcome = search_.search_rest(plan_, entry_begin(), longest, tries);
    if (outcome == Outcome::more) return false;
    if (outcome == Outcome::found) {
      const NewOrigin origin = write_cut();
      plan_.end_by_entry(search_.end().state.time, origin.state);
      writer_.ended_by_entry(plan_, origin.number);
      return true;
    }
    // The stop of a state that is not committed yet is not on the board.
    const bool is_stop_unknown = !is_from_rest && writer_.origin().is_new;
    if (!is_stop_unknown && (is_from_rest || from.time >= writer_.rest())) {
      plan_.end_as({EndKind::in_stop});
      return true;
    }
    end_search_ = EndSearch{EndAttempt::from_rest};
    search_.restart_at(0);
    if (is_stop_unknown) return false;
    if (!prepare_end(settled)) return true;
  }
}

}  // namespace splinecast::ipc
