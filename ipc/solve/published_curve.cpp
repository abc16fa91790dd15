#include "ipc/solve/published_curve.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "core/forms/stop.hpp"
#include "ipc/board/reader.hpp"
#include "ipc/board/writer.hpp"
#include "ipc/layout/knot_slots.hpp"
#include "ipc/layout/summary.hpp"

namespace splinecast::ipc {
namespace {

using core::SegmentForm;

// A window is restored from them, if no waypoint has been met.
static_assert(kPassedSlots >= core::kMaxSettle + core::kMaxReach + 3);

}  // namespace

PublishedCurve::PublishedCurve(KnotBoardWriter& board, const KnotBoardReader& published,
                               const core::WindowOptions& options, DimensionKinds kinds,
                               const EntryOptions& entries)
    : board_(&board),
      published_(&published),
      window_(published.dimensions(), options),
      trial_(published.dimensions(), options),
      kinds_(std::move(kinds)),
      entries_(entries),
      look_ahead_(std::max<std::size_t>(options.interpolant.method->look_ahead, 1)),
      has_plain_knots_(!published.smooths() && !options.interpolant.method->needs_acceleration()),
      has_limits_(!options.limits.empty()),
      cut_(board, published, kinds_),
      search_(published.dimensions(), kinds_),
      shown_(published),
      committed_shown_(published),
      read_(published.dimensions(), published.smooths()),
      knot_(published.dimensions(), published.smooths()),
      knots_(window_.knots_to_restore()),
      knot_values_(kKnotValues * published.dimensions() * window_.knots_to_restore()),
      values_(published.dimensions()),
      segment_(published.dimensions()),
      origin_state_(published.dimensions()),
      beyond_(published.dimensions()) {}

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
}

void PublishedCurve::freeze(Time t) noexcept {
  is_prepared_ = false;
  const std::size_t knots = window_.knots();
  if (course_ == Course::entering && t >= entry_end_) {
    passed_before_ += passed_over();
    course_ = Course::on_target;
    unmet_ = met_;
    origin_ = {};
  }
  // At its end the entry has met the newest waypoint that it knew.
  if (course_ == Course::beyond && ends_at_known_ && t >= behind_.end) {
    passed_before_ += known_ - 1 - unmet_;
    unmet_ = known_;
    ends_at_known_ = false;
  }
  if (course_ == Course::on_target && knots > 0) {
    window_.freeze(t);
    // The stop behind the newest knot is what readers execute from here on.
    if (t >= window_.time(knots - 1)) wait_for_entry();
  } else if (course_ == Course::waiting && !is_searching_ && knots > unmet_ && t < newest_time()) {
    // The state moves on along the stop: what has not passed may pass from there.
    search_.restart(unmet_);
    is_searching_ = true;
  }
  keep_settled();
}

/// The newest knot has been executed: what comes next is met by an entry.
void PublishedCurve::wait_for_entry() noexcept {
  course_ = Course::waiting;
  met_ = unmet_ = placed_ = window_.knots();
  // The next waypoint changes the rows of the last ones that were met, and many entries in a row
  // may push them off the board: see write_passed.
  passed_lowest_ = unmet_ - std::min(unmet_, kMetKept);
  passed_written_ = passed_committed_ = passed_lowest_;
  origin_ = {};
}

/// Before anything is changed: all knots are on the board as they are, settled ones for good.
void PublishedCurve::keep_settled() noexcept {
  kept_ = window_.settled_knots();
  // At the newest knot another segment begins with the next one.
  open_ = std::min(kept_, std::max<std::size_t>(placed_, 1) - 1);
}

bool PublishedCurve::has_room(std::size_t knots, Time keep) const noexcept {
  const bool is_counted = has_changes_ && is_on_line() && window_.knots() > 0;
  return has_room_behind(is_counted ? number_of(window_.knots()) : newest_, knots, keep);
}

bool PublishedCurve::has_room_to_cut(Time t, std::size_t knots, Time keep) const noexcept {
  return has_room_behind(segment_at(*published_, head_, t), knots, keep);
}

bool PublishedCurve::has_room_behind(Word number, std::size_t knots, Time keep) const noexcept {
  if (keep == Time::max()) return true;  // a recorded stream keeps nothing
  const Word newest = number + knots;
  const Word lost = newest - std::min<Word>(newest, board_->capacity());
  if (lost < std::max<Word>(first_, 1) || lost >= newest_) return true;
  return published_->time_hint(lost + 1) <= keep;  // where the last segment that is lost ends
}

/// For the cut, the entry, the piece of the target that is still in the window, and a stop.
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
  wait_for_entry();
  set_origin(1, state);
  note_change(state.time);
}

void PublishedCurve::begin_run(Time t, Time blend) noexcept {
  is_damaged_ = is_damaged_ || !cut_.find(head_, t);
  if (is_damaged_) return;
  cut_.write();
  run_ = cut_.next();
  run_item_ = 0;
  passed_before_ += passed_over();
  window_.begin_run();
  committed_knots_ = 0;
  wait_for_entry();
  set_origin(cut_.next(), cut_.state());
  blend_until_ = t + blend;
  is_searching_ = is_entry_new_ = is_prepared_ = false;
  committed_shown_ = shown_;
  has_forgotten_ = true;
  shown_.forget_after(t - Time(1));
  kept_ = 0;
  open_ = 0;
  note_change(t);
}

/// The first segment that an append may change and the curve may come to follow. At the start of a
/// live stream those in which the start from rest has not faded are none: where they ask for more
/// than the motion behind them, the stream starts by an entry.
std::size_t PublishedCurve::first_compared() const noexcept {
  const bool starts_at_rest = !window_.is_later_run() && window_.options().held_before_start &&
                              window_.options().start.kind == ConditionKind::halt;
  const std::size_t frozen = window_.frozen_knots();
  return std::max({is_on_line() ? met_ : unmet_, frozen - std::min<std::size_t>(frozen, 1),
                   window_.oldest_segment(), starts_at_rest ? core::kStartFades : 0});
}

/// What a window needs to go on where this one stands: its knots from passed_first() on.
std::span<const core::Knot> PublishedCurve::knots_to_go_on() noexcept {
  const std::size_t first = passed_first();
  for (std::size_t i = first; i < window_.knots(); ++i) knots_[i - first] = window_.knot(i);
  return std::span(knots_).first(window_.knots() - first);
}

std::optional<LimitExcess> PublishedCurve::find_excess(const Waypoint& waypoint) noexcept {
  const auto knots = knots_to_go_on();
  if (window_.is_later_run()) {
    trial_.restore_run(passed_first(), knots);
  } else {
    trial_.restore(passed_first(), knots);
  }
  trial_.freeze_knots(window_.frozen_knots());
  trial_.append(waypoint);
  const MotionLimits& limits = window_.options().limits;
  for (std::size_t i = std::max(first_compared(), trial_.oldest_segment()); i + 1 < trial_.knots();
       ++i) {
    trial_.segment(i, segment_);
    if (core::keeps_within(limits, &kinds_, segment_)) continue;
    const Excess found = core::worst_excess(limits, &kinds_, segment_);
    const Time left = segment_.left;
    if (i + 1 < window_.knots()) {
      window_.segment(i, segment_);
      if (!core::keeps_within(limits, &kinds_, segment_)) continue;
    }
    return LimitExcess{.kind = found.kind,
                       .dimension = found.dimension,
                       .time = left + from_seconds(found.u),
                       .value = found.value,
                       .limit = found.limit};
  }
  return std::nullopt;
}

void PublishedCurve::append(const Waypoint& waypoint, Word item) noexcept {
  if (window_.knots() == 0) run_item_ = item + 1;
  window_.append(waypoint);
  if (entries_.is_live) shown_.note(waypoint.time, waypoint.position);
  has_changes_ = true;
  if (course_ == Course::waiting || course_ == Course::beyond) {
    if (!is_searching_) restart_search();
    is_searching_ = true;
  }
  // What has settled leaves the window and is written once, with its last value.
  const std::size_t settled = window_.settled_knots();
  if (open_ >= settled) return;
  if (!is_on_line()) {
    write_passed(passed_written_, settled);
  } else {
    write_knots(std::max(open_, met_), settled);
  }
  open_ = settled;
}

void PublishedCurve::restart_search() noexcept {
  if (course_ != Course::beyond) return search_.restart(unmet_);
  search_.restart(unmet_, origin_state(),
                  {behind_.end, beyond_.position(), beyond_.velocity(), beyond_.acceleration()});
}

/// A solver that takes over reads back from the board what the motion shows, when an entry is
/// needed.
void PublishedCurve::find_shown() noexcept {
  if (knows_shown_ || !entries_.is_live) return;
  knows_shown_ = true;
  if (course_ == Course::on_target) {  // the start: the waypoints on the board are the window's
    shown_.restore(window_, *published_, head_, Time::min(), 0);
    return;
  }
  const Time end = origin_.number > 0 ? origin_.time : Time::max();
  const bool starts_stream = !window_.is_later_run() && origin_.number == 1;
  shown_.restore(window_, *published_, head_, end, starts_stream ? 0 : unmet_);
}

bool PublishedCurve::needs_entry() const noexcept {
  return is_searching_ && (course_ == Course::waiting || course_ == Course::beyond);
}

/// Whether the stream starts at rest with its first waypoint, and that can still be changed.
bool PublishedCurve::is_start_open() const noexcept {
  return course_ == Course::on_target && !window_.is_later_run() &&
         window_.options().held_before_start &&
         window_.options().start.kind == ConditionKind::halt && window_.knots() >= 2 &&
         window_.oldest_segment() == 0 && window_.frozen_knots() == 0;
}

/// The first interval of a stream that starts at rest may ask for more than the motion behind it:
/// then it starts by an entry, from rest.
void PublishedCurve::check_start() noexcept {
  const std::size_t knots = window_.knots();
  find_shown();
  if (entries_.is_live) shown_.look(window_.options().stop_time);
  if (search_.keeps_start(window_, entry_rules())) return;
  const core::Knot first = window_.knot(0);
  constexpr std::array<double, kMaxDimensions> kZeros{};
  const auto zeros = std::span(kZeros).first(window_.dimensions());
  const Instant rest{first.time, first.position, zeros, zeros};
  course_ = Course::waiting;
  met_ = placed_ = knots;
  unmet_ = 1;
  passed_lowest_ = passed_written_ = passed_committed_ = 0;
  set_origin(1, rest);
  note_change(first.time);
  search_.restart(1);
  is_searching_ = true;
}

/// Finds the state from which an entry begins: the one from which the open one will begin, if that
/// has not settled, else that of the committed curve at `settled`.
bool PublishedCurve::find_state(Time settled) noexcept {
  uses_cut_ = origin_.number == 0 || (!origin_.is_new && settled > origin_.time);
  if (!uses_cut_) return true;
  // A knot that the curve has met stays.
  const std::size_t met = is_on_line() ? window_.knots() : unmet_;
  const bool is_in_window = met > window_.oldest_segment();
  const Time t = is_in_window ? std::max(settled, window_.time(met - 1) + Time(1)) : settled;
  is_damaged_ = is_damaged_ || !cut_.find(head_, t);
  return !is_damaged_;
}

/// The state is found once in a step; what the motion shows follows each waypoint.
bool PublishedCurve::prepare(Time settled) noexcept {
  find_shown();
  if (entries_.is_live) shown_.look(window_.options().stop_time);
  is_prepared_ = is_prepared_ || find_state(settled);
  return is_prepared_;
}

core::EntryRules PublishedCurve::entry_rules() const noexcept {
  const Time from = uses_cut_ ? cut_.state().time : origin_.time;
  const bool blends = blend_until_ > from;  // of a run that none has been cut for it lies long ago
  return {
      .limits = &window_.options().limits,
      .shown = entries_.is_live ? &shown_.limits() : nullptr,
      .least = blends ? std::max(entries_.min_splice, blend_until_ - from) : entries_.min_splice};
}

void PublishedCurve::look_for_entry(Time settled, Time keep, bool is_last, int& tries) noexcept {
  if (is_damaged_ || is_ending_ || ends_there_ || window_.finished()) return;
  // With as many waypoints as a window shows, or, of a live stream, with those that are known when
  // the start is about to settle.
  if (is_start_open() && (window_.knots() == window_.options().settle + 2 ||
                          (is_last && start_decision() <= settled))) {
    check_start();
  }
  if (!needs_entry() || window_.knots() <= unmet_ || tries <= 0) return;
  if (!has_room_to_enter(keep) || !prepare(settled)) return;
  core::EntryRules rules = entry_rules();
  rules.goes_beyond = is_last && entries_.is_live;
  rules.newer = rules.goes_beyond ? 0 : window_.options().settle;
  const auto outcome =
      search_.search(window_, uses_cut_ ? cut_.state() : origin_state(), rules, tries);
  if (outcome == core::EntrySearch::Outcome::found) enter();
  const bool is_over = outcome == core::EntrySearch::Outcome::none && rules.goes_beyond;
  if (is_over) is_searching_ = false;
}

/// Makes the entry that has been found part of the curve.
void PublishedCurve::enter() noexcept {
  if (uses_cut_) {
    cut_.write();
    set_origin(cut_.next(), cut_.state());
    // The cut writes the newest knot that was met again, but not its row: see find_knot.
    passed_written_ = passed_lowest_;
  }
  is_searching_ = is_prepared_ = false;
  is_entry_new_ = true;
  const core::EntryEnd& end = search_.end();
  if (end.knot) {
    course_ = Course::entering;
    met_ = placed_ = *end.knot;
    met_number_ = origin_.number + 1;
    window_.freeze_knots(met_ + 1);
    entry_end_ = end.state.time;
    std::ranges::copy(end.state.acceleration, beyond_.ref().acceleration.begin());
    kept_ = open_ = met_;
  } else {
    course_ = Course::beyond;
    met_ = placed_ = window_.knots();
    behind_ = {.end = end.state.time, .line_end = end.line_end, .rest = end.rest};
    known_ = end.known;
    ends_at_known_ = behind_.end == window_.time(known_ - 1);
    const StateRef to = beyond_.ref();
    std::ranges::copy(end.state.position, to.position.begin());
    std::ranges::copy(end.state.velocity, to.velocity.begin());
    std::ranges::copy(end.state.acceleration, to.acceleration.begin());
  }
  note_change(origin_.time);
}

/// Enters the run at a waypoint before its last one, if one of them passes: no newer ones come. The
/// state to begin from must have been found. Tries at most the window's knots.
void PublishedCurve::enter_before_end() noexcept {
  core::EntryRules rules = entry_rules();
  rules.newer = 1;
  int tries = static_cast<int>(window_.knots() - window_.oldest_segment());
  search_.restart(unmet_);
  const Instant from = uses_cut_ ? cut_.state() : origin_state();
  if (search_.search(window_, from, rules, tries) == core::EntrySearch::Outcome::found) enter();
}

bool PublishedCurve::finish(const Condition& end, Time settled, Time keep, int& tries) noexcept {
  const std::size_t knots = window_.knots();
  if (knots == 0) return true;  // it ends with the stop that it is
  if (is_start_open()) check_start();
  if (!is_on_line() && !seeks_end_ && has_room_to_enter(keep) && prepare(settled)) {
    enter_before_end();
  }
  if (is_on_line() && window_.frozen_knots() < knots) {
    window_.finish(end);
    has_changes_ = true;
    // The last segment may come to a full stop, which is another form.
    open_ = std::min(open_, knots - std::min<std::size_t>(knots, 2));
    return true;
  }
  if (!prepare(settled)) return true;
  const Instant from = uses_cut_ ? cut_.state() : origin_state();
  const core::Knot newest = window_.knot(knots - 1);
  std::ranges::fill(values_, 0.0);
  const Instant rest{newest.time, newest.position, values_, values_};
  const auto is_zero = [](double value) { return value == 0; };
  if (std::ranges::equal(from.position, rest.position) &&
      std::ranges::all_of(from.velocity, is_zero) &&
      std::ranges::all_of(from.acceleration, is_zero)) {
    if (course_ == Course::on_target) unmet_ = knots - 1;
    met_ = std::max(unmet_, knots - 1);
    ends_there_ = true;
    return true;
  }
  if (!seeks_end_) search_.restart(0);
  seeks_end_ = true;
  const auto outcome = search_.search_rest(rest, from, entry_rules(), tries);
  if (outcome != core::EntrySearch::Outcome::found) return false;
  if (uses_cut_) {
    cut_.write();
    set_origin(cut_.next(), from);
  }
  is_entry_new_ = is_ending_ = true;
  behind_ = {.end = search_.end().state.time};
  if (course_ == Course::on_target) unmet_ = knots - 1;
  std::ranges::copy(newest.position, beyond_.ref().position.begin());
  met_ = std::max(unmet_, knots - 1);
  note_change(origin_.time);
  return true;
}

/// Waypoints that the open entry passes over.
std::size_t PublishedCurve::passed_over() const noexcept {
  const bool has_met = is_on_line() || is_ending_ || ends_there_;
  const std::size_t end = has_met ? met_ : window_.knots();
  return end - std::min(end, unmet_);
}

void PublishedCurve::committed(const Head& head) noexcept {
  has_changes_ = has_forgotten_ = false;
  is_entry_new_ = false;
  origin_.is_new = false;
  head_ = head;
  passed_committed_ = passed_written_;
  committed_knots_ = window_.knots();
  if (is_on_line()) placed_ = window_.knots();
  keep_settled();
}

}  // namespace splinecast::ipc
