#include <algorithm>

#include "core/forms/stop.hpp"
#include "ipc/solve/published_curve.hpp"

/// Searches for the entries of a published curve onto its target. An entry that is found is in
/// memory of the search; `enter` makes it part of the curve.
namespace splinecast::ipc {

/// Finds the limits that a live motion shows. If this solver has taken over the stream, first reads
/// the motion from the board.
void PublishedCurve::look_at_shown() noexcept {
  if (!is_live()) return;
  if (!shown_.is_restored()) restore_shown();
  shown_.look(window().options().stop_length);
}

void PublishedCurve::restore_shown() noexcept {
  if (core::is<core::OnTarget>(plan_.end())) {  // at the start the window has all waypoints
    shown_.restore(window(), *published_, summary_, Time::min(), 0);
    return;
  }
  const Time end = plan_.has_origin() ? plan_.origin().time : Time::max();
  shown_.restore(window(), *published_, summary_, end,
                 begins_stream() && !window().is_later_run() ? 0 : plan_.unmet());
}

/// Compares the start with the limits. While it exceeds a given one, the curve rests at the first
/// waypoint: if the solver stops before the decision, readers execute that rest. The decision also
/// compares with the limits that the later motion shows. If the start exceeds one then, the stream
/// starts by an entry from rest.
void PublishedCurve::check_start(Time settled, bool is_decision) noexcept {
  if (is_decision) look_at_shown();
  const bool keeps_limits = search_.keeps_start(plan_, is_decision ? shown() : nullptr);
  if (core::is<core::OnTarget>(plan_.end())) {
    if (keeps_limits) return;
    plan_.rest_at_start();
    writer_.rests_at_start(plan_);
  } else if (keeps_limits && settled <= window().time(0)) {
    plan_.start_on_target();
    return writer_.starts_on_target(plan_);
  }
  if (!is_decision) return;
  plan_.start_by_entry();
  writer_.starts_by_entry();
  search_.restart(plan_);
}

bool PublishedCurve::decide_start(Time t, Time settled, Time keep, int& tries) noexcept {
  const bool is_open = search_.has_limits() && is_live() && plan_.is_start_open();
  if (is_damaged_ || !is_open || t <= window().time(0)) return false;
  check_start(settled, true);
  search_entry(settled, keep, true, tries);
  return has_changes();
}

/// Finds the cut of the committed curve at t, where the next piece begins. Returns false if the
/// board is damaged.
bool PublishedCurve::find_cut(Time t) noexcept {
  uses_cut_ = true;
  is_damaged_ = is_damaged_ || !cut_.find(summary_, t);
  return !is_damaged_;
}

/// Finds the state at which an entry begins: the origin if that has not settled, else the state of
/// the committed curve at `settled`. Returns false if the board is damaged.
bool PublishedCurve::find_state(Time settled) noexcept {
  const CurveOrigin& origin = writer_.origin();
  const bool has_origin = plan_.has_origin();
  const Time begin = plan_.origin().time;
  const bool is_kept = settled > begin || origin.stopped_by > 0;
  uses_cut_ = false;
  if (has_origin && (origin.is_new || !is_kept)) return true;
  // The entry must begin after the last knot that the curve meets. That of a curve that has left
  // its target may be later than `settled`; it is the newest knot of the committed curve.
  Time t = settled;
  if (is_on_target() && window().knots() > 0) {
    t = std::max(t, plan_.newest_time() + Time(1));
  } else if (!has_origin) {
    t = std::max(t, published_->time_hint(summary_.newest) + Time(1));
  } else if (origin.stopped_by > 0) {
    t = std::max(t, begin + Time(1));  // its knot says whose stop began there
  }
  return find_cut(t);
}

/// Finds how far the published curve goes from that state to `until`. If the curve has been cut
/// there since the last commit, keeps what was found before the cut; a start state, number 1, cuts
/// no curve. Returns false if the board is damaged.
bool PublishedCurve::find_reach(Time until) noexcept {
  const bool is_pending = !uses_cut_ && writer_.origin().is_new;
  if (is_pending && writer_.origin().number > 1) return true;
  const Instant from = begin_state();
  core::PositionRange& reach = search_.reach();
  reach.restart(from.position);
  if (is_pending) {
    (void)core::build_stop_within(window().stop_rules(), from, segment_);
    reach.add(core::part_of(segment_));
    return true;
  }
  for (Word n = segment_at(*published_, summary_, from.time); n <= summary_.newest; ++n) {
    const auto taken = read_.take(*published_, summary_, n);
    is_damaged_ = is_damaged_ || taken == BoardSegment::Taken::torn;
    if (taken != BoardSegment::Taken::whole || read_.right() <= from.time) continue;
    if (read_.left() >= until) break;
    reach.add({.order = read_.order(),
               .coefficients = read_.coefficients(),
               .dimensions = from.position.size(),
               .from = std::max(to_seconds(from.time - read_.left()), 0.0),
               .to = to_seconds(read_.right() - read_.left())});
  }
  return !is_damaged_;
}

/// Prepares a search: updates the shown motion and, once per step, finds the state at which an
/// entry begins. Returns false if the board is damaged.
bool PublishedCurve::prepare(Time settled) noexcept {
  look_at_shown();
  is_prepared_ = is_prepared_ || (find_state(settled) && find_reach(Time::max()));
  return is_prepared_;
}

void PublishedCurve::look_for_entry(Time settled, Time keep, bool is_last, int& tries) noexcept {
  if (is_damaged_ || plan_.ended()) return;
  // Decides the start when settle + 2 waypoints are known or, on a live stream, shortly before the
  // start settles.
  if (plan_.is_start_open()) {
    const std::size_t decisive = window().options().settle + 2;
    const bool is_decision =
        window().knots() == decisive || (is_last && start_decision() <= settled);
    const bool may_stop_before = search_.has_limits() && is_live() && window().knots() < decisive;
    if (is_decision || may_stop_before) check_start(settled, is_decision);
  }
  search_entry(settled, keep, is_last, tries);
}

/// Searches for the entry that the curve needs, if it needs one.
void PublishedCurve::search_entry(Time settled, Time keep, bool is_last, int& tries) noexcept {
  if (!core::is_searching(plan_.end()) || window().knots() <= plan_.unmet() || tries <= 0) return;
  if (!has_room_to_enter(keep) || !prepare(settled)) return;
  using Outcome = core::PlanSearch::Outcome;
  const Outcome outcome = search_.search(plan_, entry_begin(), is_last, tries);
  if (outcome == Outcome::found) enter();
  if (outcome == Outcome::none && is_last && is_live()) plan_.set_searching(false);
}

/// Makes the entry that was found part of the curve.
void PublishedCurve::enter() noexcept {
  const NewOrigin origin = write_cut();
  plan_.enter(search_.end(), origin.state);
  writer_.entered(plan_, origin.number);
  is_prepared_ = false;
}

void PublishedCurve::enter_before_cut(Time settled, Time keep) noexcept {
  if (!is_damaged_ && has_room_to_enter(keep) && prepare(settled) &&
      search_.search_before_end(plan_, entry_begin())) {
    enter();
  }
}

}  // namespace splinecast::ipc
