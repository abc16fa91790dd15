#include <algorithm>

#include "ipc/solve/published_curve.hpp"

/// Ends a published curve.
namespace splinecast::ipc {
namespace {

bool rests_at(const Instant& state, std::span<const double> position) noexcept {
  const auto is_zero = [](double value) { return value == 0; };
  return std::ranges::equal(state.position, position) &&
         std::ranges::all_of(state.velocity, is_zero) &&
         std::ranges::all_of(state.acceleration, is_zero);
}

}  // namespace

/// Ends the curve at the newest waypoint. Requires that it ends with a piece of the target.
void PublishedCurve::finish_on_line(const Condition& end) noexcept {
  const std::size_t knots = window_.knots();
  window_.finish(end);
  has_changes_ = true;
  // A full stop changes the form of the last segment: its left knot is written again.
  open_ = std::min(open_, knots - std::min<std::size_t>(knots, 2));
}

/// Marks the newest waypoint as met by a curve that does not reach it on the target.
void PublishedCurve::end_at_newest() noexcept {
  const std::size_t last = window_.knots() - 1;
  if (course_ == Course::on_target) unmet_ = last;
  met_ = std::max(unmet_, last);
}

/// Ends the curve with the entry that the search found, which comes to rest at the newest waypoint.
void PublishedCurve::enter_end(const Instant& from) noexcept {
  if (uses_cut_) {
    cut_.write();
    set_origin(cut_.next(), from);
  }
  is_entry_new_ = is_ending_ = true;
  behind_ = {.end = search_.end().state.time};
  const auto newest = window_.knot(window_.knots() - 1).position;
  std::ranges::copy(newest, beyond_.ref().position.begin());
  end_at_newest();
  note_change(origin_.time);
}

bool PublishedCurve::finish(const Condition& end, Time settled, Time keep, int& tries) noexcept {
  const std::size_t knots = window_.knots();
  if (knots == 0) return true;  // the curve ends with its current stop
  if (is_start_open()) check_start();
  if (!is_on_line() && !seeks_end_ && has_room_to_enter(keep) && prepare(settled)) {
    enter_before_end();
  }
  if (is_on_line() && window_.frozen_knots() < knots) {
    finish_on_line(end);
    return true;
  }
  if (!prepare(settled)) return true;
  const Instant from = uses_cut_ ? cut_.state() : origin_state();
  const core::Knot newest = window_.knot(knots - 1);
  std::ranges::fill(values_, 0.0);
  const Instant rest{newest.time, newest.position, values_, values_};
  if (rests_at(from, rest.position)) {
    end_at_newest();
    ends_there_ = true;
    return true;
  }
  if (!seeks_end_) search_.restart(0);
  seeks_end_ = true;
  core::EntryRules rules = entry_rules();
  rules.must_reach = true;
  const auto outcome = search_.search_rest(rest, from, rules, tries);
  if (outcome != core::EntrySearch::Outcome::found) return false;
  enter_end(from);
  return true;
}

}  // namespace splinecast::ipc
