#include "ipc/solve/published_curve.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "core/forms/stop.hpp"
#include "core/limits/limit_of.hpp"
#include "ipc/board/reader.hpp"
#include "ipc/board/writer.hpp"
#include "ipc/layout/knot_slots.hpp"
#include "ipc/layout/summary.hpp"

namespace splinecast::ipc {
namespace {

using core::SegmentForm;

// If the curve has met no waypoint of a run, its window is restored from the passed slots alone.
static_assert(kPassedSlots >= core::kMaxSettle + core::kMaxReach + 3);

}  // namespace

PublishedCurve::PublishedCurve(KnotBoardWriter& board, const KnotBoardReader& published,
                               const core::WindowOptions& options, DimensionKinds kinds,
                               const EntryOptions& entries)
    : board_(&board),
      published_(&published),
      kinds_(std::move(kinds)),
      window_(published.dimensions(), core::with_kinds(options, kinds_)),
      trial_(published.dimensions(), core::with_kinds(options, kinds_)),
      entries_(entries),
      look_ahead_(std::max<std::size_t>(options.interpolant.method->look_ahead, 1)),
      has_plain_knots_(!published.smooths() && !options.interpolant.method->needs_acceleration()),
      has_limits_(!options.limits.empty()),
      cut_(board, published, kinds_, window_.limits_at_largest_rate()),
      search_(published.dimensions(), kinds_),
      slowed_(published, kinds_),
      end_limits_(options.limits),
      reach_(published.dimensions()),
      shown_(published),
      read_(published.dimensions(), published.smooths()),
      knot_(published.dimensions(), published.smooths()),
      knots_(window_.knots_to_restore()),
      knot_values_(kKnotValues * published.dimensions() * window_.knots_to_restore()),
      values_(published.dimensions()),
      segment_(published.dimensions()),
      origin_state_(published.dimensions()),
      beyond_(published.dimensions()) {
  end_limits_.acceleration.resize(published.dimensions());
}

void PublishedCurve::prefetch() const noexcept {
  window_.prefetch();
  if (is_on_line()) board_->prefetch(number_of(std::max(open_, met_)), newest_ + 1);
}

Time PublishedCurve::newest_time() const noexcept {
  if (window_.knots() > 0) return window_.time(window_.knots() - 1);
  return origin_.time;
}

Time PublishedCurve::settled_until() const noexcept {
  const std::size_t knots = window_.knots();
  if (knots == 0 || !is_on_line()) return origin_.time;
  return window_.time(std::min(window_.settled_segments(), knots - 1));
}

std::span<const double> PublishedCurve::newest_position() const noexcept {
  if (window_.knots() > 0) return window_.knot(window_.knots() - 1).waypoint;
  return window_.is_later_run() ? origin_state_.position() : std::span<const double>{};
}

Instant PublishedCurve::origin_state() const noexcept {
  return {.time = origin_.time,
          .position = origin_state_.position(),
          .velocity = origin_state_.velocity(),
          .acceleration = origin_state_.acceleration()};
}

void PublishedCurve::set_origin(Word number, const Instant& state) noexcept {
  origin_ = {.number = number, .time = state.time, .is_new = true};
  const StateRef to = origin_state_.ref();
  std::ranges::copy(state.position, to.position.begin());
  std::ranges::copy(state.velocity, to.velocity.begin());
  std::ranges::copy(state.acceleration, to.acceleration.begin());
  core::clamp_acceleration(window_.limits_at_largest_rate(), kinds_, to.velocity, to.acceleration);
}

void PublishedCurve::freeze(Time t) noexcept {
  is_prepared_ = false;
  const std::size_t knots = window_.knots();
  const auto* const entering = std::get_if<core::Entering>(&end_);
  if (entering != nullptr && t >= entering->end) {
    passed_before_ += passed_over();
    end_ = core::OnTarget{};
    unmet_ = met_;
    origin_ = {};
  }
  // This entry ends at the newest waypoint that it knew, which the curve has now met.
  auto* const ahead = std::get_if<core::EnteringAhead>(&end_);
  if (ahead != nullptr && ahead->ends_at_known && t >= ahead->after.end) {
    passed_before_ += ahead->known - 1 - unmet_;
    unmet_ = ahead->known;
    ahead->ends_at_known = false;
    note_met();
  }
  if (core::is<core::OnTarget>(end_) && knots > 0) {
    window_.freeze(t);
    // The newest knot is frozen: readers follow the stop after it.
    if (t >= window_.time(knots - 1)) wait_for_entry(window_.knots());
  } else if (core::is<core::Waiting>(end_) && !core::is_searching(end_) && !has_given_up() &&
             knots > unmet_ && t < newest_time()) {
    // The entry would now begin later in the stop, in another state: candidates that failed before
    // may now keep the limits.
    search_.restart(unmet_);
    core::set_searching(end_, true);
  }
  keep_settled();
}

/// Makes the end of the curve final: only an entry can lead to the next waypoint. The curve meets
/// the leading `met` knots of the run.
void PublishedCurve::wait_for_entry(std::size_t met) noexcept {
  end_ = core::Waiting{};
  met_ = placed_ = window_.knots();
  unmet_ = met;
  // The next waypoint changes the rows of the last met knots, and many entries in sequence may push
  // these knots off the board. So write_passed() writes them to the passed slots.
  passed_lowest_ = unmet_ - std::min(unmet_, kMetKept);
  passed_written_ = passed_committed_ = passed_lowest_;
  origin_ = {};
  note_met();
}

/// Records that the curve meets all knots before unmet_.
void PublishedCurve::note_met() noexcept {
  refused_until_ = unmet_since_ = Time::max();
  if (!entries_.keeps_limits || unmet_ >= window_.knots()) return;
  unmet_since_ = unmet_ >= window_.oldest_segment() ? window_.time(unmet_) : newest_time();
}

/// Records which knots are final. Call it when all knots are on the board, before a revision
/// changes any.
void PublishedCurve::keep_settled() noexcept {
  kept_ = window_.settled_knots();
  // The next knot changes the segment that begins at the newest one.
  open_ = std::min(kept_, std::max<std::size_t>(placed_, 1) - 1);
}

bool PublishedCurve::has_room(std::size_t knots, Time keep) const noexcept {
  const bool is_counted = has_changes_ && is_on_line() && window_.knots() > 0;
  return has_room_behind(is_counted ? number_of(window_.knots()) : newest_, knots, keep);
}

bool PublishedCurve::has_room_to_cut(Time t, std::size_t knots, Time keep) const noexcept {
  return has_room_behind(segment_at(*published_, summary_, t), knots, keep);
}

bool PublishedCurve::has_room_behind(Word number, std::size_t knots, Time keep) const noexcept {
  if (keep == Time::max()) return true;  // a recorded stream keeps no history
  const Word newest = number + knots;
  const Word lost = newest - std::min<Word>(newest, board_->capacity());
  if (lost < std::max<Word>(first_, 1) || lost >= newest_) return true;
  return published_->time_hint(lost + 1) <= keep;  // end of the last segment that is lost
}

/// Whether there is room for the cut, the entry, the piece of the target that is still in the
/// window, and a stop.
bool PublishedCurve::has_room_to_enter(Time keep) const noexcept {
  const std::size_t added = window_.knots() - window_.oldest_segment() + 3 + kAddedByStop;
  return newest_ == 0 || has_room_behind(newest_, added, keep);
}

Time PublishedCurve::earliest_cut() const noexcept {
  Time left{};
  SegmentForm form{};
  if (newest_ == 0 || !published_->copy_time(first_, board_->revision(), left, form)) {
    return Time::max();
  }
  const bool is_held =
      first_ == 1 && !window_.is_later_run() && window_.options().held_before_start;
  return is_held ? Time::min() : left;
}

void PublishedCurve::note_change(Time from) noexcept {
  changed_from_ = std::min(changed_from_, from);
  has_changes_ = true;
}

void PublishedCurve::begin(const Instant& state) noexcept {
  window_.begin_run();
  committed_knots_ = 0;
  wait_for_entry(window_.knots());
  set_origin(1, state);
  note_change(state.time);
}

void PublishedCurve::begin_run(Time t, const RunBegin& how) noexcept {
  is_damaged_ = is_damaged_ || !cut_.find(summary_, t);
  if (is_damaged_) return;
  if (how.is_from_rest) cut_.come_to_rest();
  uses_cut_ = true;
  if (!find_reach(Time::max())) return;
  if (auto* const ahead = std::get_if<core::EnteringAhead>(&end_)) {
    ahead->ends_at_known = ahead->ends_at_known && t >= ahead->after.end;
  }
  cut_.write();
  run_ = cut_.next();
  run_item_ = 0;
  passed_before_ += passed_over();
  window_.begin_run();
  committed_knots_ = 0;
  wait_for_entry(window_.knots());
  set_origin(cut_.next(), cut_.state());
  origin_.is_corner = how.is_from_rest;
  origin_.stopped_by = how.stopped_by;
  blend_until_ = t + how.blend;
  is_entry_new_ = is_prepared_ = false;
  shown_.begin_cut();
  if (how.has_waypoints) {
    shown_.replace_from_next();
  } else {
    shown_.forget_after(t - Time(1));
  }
  kept_ = 0;
  open_ = 0;
  note_change(t);
}

void PublishedCurve::append(const Waypoint& waypoint, Word item) noexcept {
  if (window_.knots() == 0) run_item_ = item + 1;
  window_.append(waypoint);
  if (entries_.is_live) shown_.note(waypoint.time, waypoint.position);
  has_changes_ = true;
  if (core::may_enter(end_)) {
    if (!core::is_searching(end_)) restart_search();
    core::set_searching(end_, true);
    if (unmet_since_ == Time::max()) note_met();
  }
  // Settled knots leave the window and are written once, with their final values.
  const std::size_t settled = window_.settled_knots();
  if (open_ >= settled) return;
  if (!is_on_line()) {
    write_passed(passed_written_, settled);
  } else {
    write_knots(std::max(open_, met_), settled);
  }
  open_ = settled;
}

Word PublishedCurve::waypoints_after(Time t) const noexcept {
  if (!is_on_line()) return 0;
  return std::min<Word>(newest_ - segment_at(*published_, summary_, t), window_.knots() - met_);
}

/// Waypoints that the open entry passes over.
std::size_t PublishedCurve::passed_over() const noexcept {
  if (core::is<core::Starting>(end_)) return 0;  // not decided yet
  const bool ends_at_newest = ending() == EndKind::as_requested || ending() == EndKind::entered;
  const bool has_met = is_on_line() || ends_at_newest;
  const std::size_t end = has_met ? met_ : window_.knots();
  const std::size_t over = end - std::min(end, unmet_);
  const auto* const ahead = std::get_if<core::EnteringAhead>(&end_);
  const bool meets_end = !has_met && ahead != nullptr && ahead->ends_at_known;
  return over - (meets_end ? 1 : 0);
}

void PublishedCurve::committed(const Summary& summary) noexcept {
  has_changes_ = false;
  shown_.committed();
  is_entry_new_ = is_prepared_ = false;  // the reach of an entry is that of the committed curve
  origin_.is_new = false;
  summary_ = summary;
  passed_committed_ = passed_written_;
  committed_knots_ = window_.knots();
  if (is_on_line()) placed_ = window_.knots();
  keep_settled();
}

}  // namespace splinecast::ipc
