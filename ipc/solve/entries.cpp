#include <algorithm>
#include <array>

#include "core/forms/stop.hpp"
#include "ipc/solve/published_curve.hpp"

/// Plans the entries of a published curve onto its target. A plan is in scratch memory; `enter`
/// makes it part of the curve.
namespace splinecast::ipc {

void PublishedCurve::restart_search() noexcept {
  const auto* const ahead = std::get_if<core::EnteringAhead>(&end_);
  if (ahead == nullptr) return search_.restart(unmet_);
  search_.restart(
      unmet_, origin_state(),
      {ahead->after.end, beyond_.position(), beyond_.velocity(), beyond_.acceleration()});
}

/// Finds the limits that a live motion shows. If this solver has taken over the stream, first reads
/// the motion from the board.
void PublishedCurve::look_at_shown() noexcept {
  if (!entries_.is_live) return;
  if (!shown_.is_restored()) restore_shown();
  shown_.look(window_.options().stop_time);
}

void PublishedCurve::restore_shown() noexcept {
  if (core::is<core::OnTarget>(end_)) {  // at the start the window has all waypoints of the stream
    shown_.restore(window_, *published_, summary_, Time::min(), 0);
    return;
  }
  const Time end = origin_.number > 0 ? origin_.time : Time::max();
  const bool starts_stream = !window_.is_later_run() && origin_.number == 1;
  shown_.restore(window_, *published_, summary_, end, starts_stream ? 0 : unmet_);
}

/// Whether the run is the first one, and starts at rest at its first waypoint.
bool PublishedCurve::starts_from_halt() const noexcept {
  const core::WindowOptions& options = window_.options();
  return !window_.is_later_run() && options.held_before_start &&
         options.start.kind == ConditionKind::halt;
}

/// Whether such a start can still be changed.
bool PublishedCurve::is_start_open() const noexcept {
  const bool may_change = core::is<core::OnTarget>(end_) || core::is<core::Starting>(end_);
  return may_change && starts_from_halt() && window_.knots() >= 2 &&
         window_.oldest_segment() == 0 && window_.frozen_knots() == 0;
}

/// Lets the published curve rest at the first waypoint.
void PublishedCurve::rest_at_start() noexcept {
  const core::Knot first = window_.knot(0);
  constexpr std::array<double, kMaxDimensions> kRest{};
  const auto zeros = std::span(kRest).first(window_.dimensions());
  end_ = core::Starting{};
  met_ = placed_ = window_.knots();
  unmet_ = 1;
  passed_lowest_ = passed_written_ = passed_committed_ = 0;
  set_origin(1, {first.time, first.position, zeros, zeros});
  note_change(first.time);
}

/// Ends that rest before it has settled: the curve follows its target from the start.
void PublishedCurve::start_on_target() noexcept {
  end_ = core::OnTarget{};
  met_ = placed_ = unmet_ = kept_ = open_ = 0;
  met_number_ = 1;
  origin_ = {};
  note_change(window_.time(0));
}

/// Compares the start with the limits. While it exceeds a given one, the curve rests at the first
/// waypoint: if the solver stops before the decision, readers execute that rest. The decision also
/// compares with the limits that the later motion shows. If the start exceeds one then, the stream
/// starts by an entry from rest.
void PublishedCurve::check_start(Time settled, bool is_decision) noexcept {
  core::EntryRules rules = entry_rules();
  if (is_decision) {
    look_at_shown();
  } else {
    rules.shown = nullptr;
  }
  const bool keeps_limits = search_.keeps_start(window_, rules);
  if (core::is<core::OnTarget>(end_)) {
    if (keeps_limits) return;
    rest_at_start();
  } else if (keeps_limits && settled <= window_.time(0)) {
    return start_on_target();
  }
  if (!is_decision) return;
  end_ = core::Waiting{.is_searching = true};
  has_changes_ = true;
  note_met();
  search_.restart(1);
}

bool PublishedCurve::decide_start(Time t, Time settled, Time keep, int& tries) noexcept {
  const bool is_open = has_limits_ && entries_.is_live && is_start_open();
  if (is_damaged_ || !is_open || t <= window_.time(0)) return false;
  check_start(settled, true);
  search_entry(settled, keep, true, tries);
  return has_changes_;
}

/// Finds the state at which an entry begins: the origin if that has not settled, else the state of
/// the committed curve at `settled`. Returns false if the board is damaged.
bool PublishedCurve::find_state(Time settled) noexcept {
  const bool is_kept = settled > origin_.time || origin_.stopped_by > 0;
  uses_cut_ = origin_.number == 0 || (!origin_.is_new && is_kept);
  if (!uses_cut_) return true;
  // The entry must begin after the last knot that the curve meets. That of a curve that has left
  // its target may be later than `settled`; it is the newest knot of the committed curve.
  Time t = settled;
  if (is_on_line() && window_.knots() > 0) {
    t = std::max(t, newest_time() + Time(1));
  } else if (origin_.number == 0) {
    t = std::max(t, published_->time_hint(summary_.newest) + Time(1));
  } else if (origin_.stopped_by > 0) {
    t = std::max(t, origin_.time + Time(1));  // its knot says whose stop began there
  }
  is_damaged_ = is_damaged_ || !cut_.find(summary_, t);
  return !is_damaged_;
}

/// Finds how far the published curve goes from that state to `until`. If the curve has been cut
/// there since the last commit, keeps what was found before the cut; a start state, number 1, cuts
/// no curve. Returns false if the board is damaged.
bool PublishedCurve::find_reach(Time until) noexcept {
  const bool is_pending = !uses_cut_ && origin_.is_new;
  if (is_pending && origin_.number > 1) return true;
  const Instant from = begin_state();
  reach_.restart(from.position);
  if (is_pending) {
    (void)core::build_stop_within(window_.stop_rules(), from, segment_);
    reach_.add(core::part_of(segment_));
    return true;
  }
  for (Word n = segment_at(*published_, summary_, from.time); n <= summary_.newest; ++n) {
    const auto taken = read_.take(*published_, summary_, n);
    is_damaged_ = is_damaged_ || taken == BoardSegment::Taken::torn;
    if (taken != BoardSegment::Taken::whole || read_.right() <= from.time) continue;
    if (read_.left() >= until) break;
    reach_.add({.order = read_.order(),
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

core::EntryRules PublishedCurve::entry_rules() const noexcept {
  const Time from = uses_cut_ ? cut_.state().time : origin_.time;
  const bool blends = blend_until_ > from;  // only in a run that began with a cut
  return {.limits = &window_.limits_at_largest_rate(),
          .path_limits = &window_.options().limits,
          .shown = entries_.is_live ? &shown_.limits() : nullptr,
          .least = blends ? std::max(entries_.min_entry, blend_until_ - from) : entries_.min_entry,
          .reach = &reach_,
          .falls_back = !entries_.keeps_limits};
}

void PublishedCurve::look_for_entry(Time settled, Time keep, bool is_last, int& tries) noexcept {
  if (is_damaged_ || ending() != EndKind::none) return;
  // Decides the start when settle + 2 waypoints are known or, on a live stream, shortly before the
  // start settles.
  if (is_start_open()) {
    const std::size_t decisive = window_.options().settle + 2;
    const bool is_decision =
        window_.knots() == decisive || (is_last && start_decision() <= settled);
    const bool may_stop_before = has_limits_ && entries_.is_live && window_.knots() < decisive;
    if (is_decision || may_stop_before) check_start(settled, is_decision);
  }
  search_entry(settled, keep, is_last, tries);
}

/// Searches for the entry that the curve needs, if it needs one.
void PublishedCurve::search_entry(Time settled, Time keep, bool is_last, int& tries) noexcept {
  if (!core::is_searching(end_) || window_.knots() <= unmet_ || tries <= 0) return;
  if (!has_room_to_enter(keep) || !prepare(settled)) return;
  core::EntryRules rules = entry_rules();
  rules.goes_beyond = is_last && entries_.is_live;
  rules.newer = rules.goes_beyond ? 0 : window_.options().settle;
  const auto outcome = search_.search(window_, begin_state(), rules, tries);
  if (outcome == core::EntrySearch::Outcome::found) enter();
  const bool is_over = outcome == core::EntrySearch::Outcome::none && rules.goes_beyond;
  if (is_over) core::set_searching(end_, false);
}

/// Makes the entry that was found part of the curve.
void PublishedCurve::enter() noexcept {
  if (uses_cut_) {
    cut_.write();
    set_origin(cut_.next(), cut_.state());
    // The cut rewrites the newest met knot, but not its row. So the row must be in the passed
    // slots: see find_knot.
    passed_written_ = passed_lowest_;
  }
  is_prepared_ = false;
  is_entry_new_ = true;
  const core::EntryEnd& end = search_.end();
  if (end.knot) {
    end_ = core::Entering{end.state.time};
    met_ = placed_ = *end.knot;
    met_number_ = origin_.number + 1;
    window_.freeze_knots(met_ + 1);
    refused_until_ = unmet_since_ = Time::max();
    std::ranges::copy(end.state.acceleration, beyond_.ref().acceleration.begin());
    kept_ = open_ = met_;
  } else {
    end_ = core::EnteringAhead{
        .after = {.end = end.state.time, .line_end = end.line_end, .rest = end.rest},
        .known = end.known,
        .ends_at_known = end.state.time == window_.time(end.known - 1)};
    met_ = placed_ = window_.knots();
    const StateRef to = beyond_.ref();
    std::ranges::copy(end.state.position, to.position.begin());
    std::ranges::copy(end.state.velocity, to.velocity.begin());
    std::ranges::copy(end.state.acceleration, to.acceleration.begin());
  }
  note_change(origin_.time);
}

void PublishedCurve::enter_before_cut(Time settled, Time keep) noexcept {
  if (!is_damaged_ && has_room_to_enter(keep) && prepare(settled)) enter_before_end();
}

/// Searches for an entry that ends at a waypoint before the last one, and makes it part of the
/// curve. Used at the end of a run, when no newer waypoints come. Requires prepare(). Tries at
/// most as many candidates as the window has knots.
void PublishedCurve::enter_before_end() noexcept {
  core::EntryRules rules = entry_rules();
  rules.newer = 1;
  int tries = static_cast<int>(window_.knots() - window_.oldest_segment());
  search_.restart(unmet_);
  if (search_.search(window_, begin_state(), rules, tries) == core::EntrySearch::Outcome::found) {
    enter();
  }
}

}  // namespace splinecast::ipc
