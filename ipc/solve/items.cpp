#include <algorithm>
#include <array>

#include "core/laws/law_path.hpp"
#include "core/limits/check.hpp"
#include "ipc/solve/stream_solver.hpp"

/// Accepts or refuses the items of a ring, and records their outcomes; begins the stops of
/// stoppers.
namespace splinecast::ipc {
namespace {

/// The reason to refuse a waypoint whose interval has this status.
Refusal to_refusal(AppendStatus interval) noexcept {
  switch (interval) {
    case AppendStatus::duplicate:
      return Refusal::duplicate;
    case AppendStatus::out_of_order:
      return Refusal::out_of_order;
    case AppendStatus::too_close:
      return Refusal::too_close;
    default:
      return Refusal::too_far_apart;
  }
}

}  // namespace

void StreamSolver::handle(Word number) noexcept {
  if (summary_.finished) return refuse(number, Refusal::after_finish);
  if (is_held() && moves(item_)) {
    return item_.kind == ItemKind::replace ? refuse_replacement(number, Refusal::stopped)
                                           : refuse(number, Refusal::stopped);
  }
  if (number == unsound_.item) {
    return item_.kind == ItemKind::replace ? refuse_replacement(number, Refusal::not_finite)
                                           : refuse(number, Refusal::not_finite);
  }
  switch (item_.kind) {
    case ItemKind::waypoint:
      return handle_waypoint(number);
    case ItemKind::replace:
      return handle_replacement(number);
    case ItemKind::start_state:
      return handle_start_state(number);
    case ItemKind::finish:
      return handle_finish(number);
    case ItemKind::rate:
      return handle_plan(number);
  }
  refuse(number, Refusal::unknown_kind);
}

/// Where a replacement from t on cuts the curve: never too late.
Time StreamSolver::time_of_cut(Time t) const noexcept {
  return std::max({t, step_.settled_until, curve_.earliest_cut()});
}

/// Whether the law holds the stream where the curve can be cut.
bool StreamSolver::can_rest() const noexcept {
  return step_.held_from && curve_.has_begun() && *step_.held_from >= curve_.earliest_cut();
}

/// Cuts the curve at t and begins a run there: from rest where the law holds, instead of what has
/// settled after it.
void StreamSolver::begin_run(Time t, const RunBegin& how) noexcept {
  outcomes_.cut(curve_.progress(), t);
  if (how.is_from_rest) step_.settled_until = t;
  step_.begins_held = step_.begins_held || how.is_from_rest;
  curve_.begin_run(t, how);
  summary_.starved = false;
  summary_.newest_time = t;
}

/// Ends a stop that is executed when the law holds the machine.
void StreamSolver::rest_where_held() noexcept {
  if (!can_rest() || *step_.held_from > step_.settled_until || summary_.finished) return;
  const Time latest = latest_from_rest(*step_.held_from, step_.settled_until, live_->settle_ahead);
  if (curve_.is_stopping(*step_.held_from, latest))
    begin_run(*step_.held_from, {.has_waypoints = false, .is_from_rest = true});
}

/// Reads what the stoppers request. If one holds the stream and the curve does not stop yet, begins
/// a stop as soon as possible, as that of a producer. Returns whether it does.
bool StreamSolver::stops_where_held() noexcept {
  if (stoppers_ == nullptr) return false;
  stops_.update(stoppers_->read());
  summary_.holders = stops_.holders();
  summary_.holder = stops_.holder();
  if (!is_held() || !curve_.has_begun() || summary_.finished) return false;
  const bool rests = can_rest() && *step_.held_from <= step_.settled_until;
  const Time t = rests ? *step_.held_from : time_of_cut(Time::min());
  if (curve_.is_stop() && t >= curve_.plan().newest_time()) return false;
  summary_.cut_off += curve_.waypoints_after(t);
  begin_run(t, {.has_waypoints = false,
                .is_from_rest = rests,
                .stopped_by = stop_item({summary_.consumed, summary_.holder})});
  return true;
}

/// Begins the curve at rest where an earlier stream of the name has left the machine. The producer
/// has compared only its first waypoint with that place, and a stopper's hold has refused it.
void StreamSolver::begin_where_left() noexcept {
  const bool is_start_lost = summary_.reasons[static_cast<std::size_t>(Refusal::stopped)] > 0;
  if (curve_.has_begun() || !is_start_lost) return;
  constexpr std::array<double, kMaxDimensions> kZeros{};
  std::array<double, kMaxDimensions> place{};
  const auto position = std::span(place).first(ring_->dimensions());
  const auto zeros = std::span(kZeros).first(ring_->dimensions());
  if (!published_->copy_old_end(position)) return;
  curve_.begin({step_.settled_until, position, zeros, zeros});
  summary_.newest_time = step_.settled_until;
}

/// The reason to refuse the values of a waypoint, if any. The producer has checked most of them,
/// but data from another process are never trusted.
std::optional<Refusal> StreamSolver::form_refusal(const Waypoint& waypoint) const noexcept {
  if (!is_finite(waypoint)) return Refusal::not_finite;
  if (!curve_.kinds().takes(waypoint.position)) return Refusal::zero_quaternion;
  if (!curve_.window().takes(waypoint)) return Refusal::lacks_derivatives;
  if (!is_time_in_range(waypoint.time)) return Refusal::too_far_apart;
  return std::nullopt;
}

std::optional<Refusal> StreamSolver::time_refusal(Time time) const noexcept {
  if (!curve_.has_begun()) {
    if (!live_) return std::nullopt;
    // The producer has compared only the first waypoint with the end of an earlier stream.
    const bool is_start_lost = summary_.reasons[static_cast<std::size_t>(Refusal::past)] > 0;
    if (is_start_lost && published_->has_old_end()) return Refusal::past;
    return time < step_.settled_until ? std::optional(Refusal::past) : std::nullopt;
  }
  const Time newest = curve_.plan().newest_time();
  // A run may begin after the time of its first waypoints, or less than an interval before it.
  if (curve_.is_stop() && time - newest < intervals_.least) return std::nullopt;
  const Time earliest = is_starved() ? step_.settled_until : newest;
  const auto status = judge_interval(time - newest, intervals_);
  if (status == AppendStatus::too_far_apart && time - earliest > intervals_.most) {
    return Refusal::too_far_apart;
  }
  if (status != AppendStatus::accepted && status != AppendStatus::too_far_apart) {
    return to_refusal(status);
  }
  const bool is_late = is_starved() && time < step_.settled_until - kMostLate;
  if (is_late && !curve_.begins_after(time)) return Refusal::past;
  return curve_.window().lag_suffices(time) ? std::nullopt : std::optional(Refusal::lag_too_short);
}

void StreamSolver::handle_waypoint(Word number) noexcept {
  Waypoint waypoint = item_.waypoint();
  if (const auto refusal = form_refusal(waypoint)) return refuse(number, *refusal);
  if (const auto refusal = time_refusal(waypoint.time)) return refuse(number, *refusal);
  begin_where_left();
  if (!curve_.kinds().all_linear()) {
    waypoint = curve_.nearest(waypoint);
    if (!is_finite(waypoint)) return refuse(number, Refusal::not_finite);
  }
  if (const auto refusal = append(waypoint, number)) return refuse(number, *refusal);
  if (step_.is_postponed) return;
  outcomes_.accept(number, waypoint.time);
  if (waypoint.time > step_.settled_until) summary_.starved = false;
  ++summary_.knots;
  summary_.newest_time = waypoint.time;
}

/// Appends a waypoint to the curve, as `beyond` specifies. Returns why to refuse it, if so.
std::optional<Refusal> StreamSolver::append(const Waypoint& waypoint, Word number) noexcept {
  if (!live_ || beyond_ != Beyond::enter) {
    const bool is_refused = note_excess(curve_.excess_with(waypoint, step_.settled_until), number);
    if (is_refused) return Refusal::beyond_limits;
    curve_.append(waypoint, number);
    return std::nullopt;
  }
  std::optional<LimitExcess> excess;
  const auto followed =
      curve_.follow(waypoint, number, step_.settled_until, step_.keep, step_.tries, excess);
  step_.is_postponed = followed == Followed::waits;
  if (followed == Followed::refused) return Refusal::cannot_follow;
  if (!step_.is_postponed) (void)note_excess(excess, number);
  return std::nullopt;
}

/// Notes where the curve with a waypoint exceeds a limit. Returns whether to refuse the waypoint.
bool StreamSolver::note_excess(const std::optional<LimitExcess>& excess, Word number) noexcept {
  const bool is_refused = excess && beyond_ == Beyond::refuse;
  count_excess(excess, number, is_refused);
  return is_refused;
}

/// Counts an excess, if there is one, and writes it to the board.
void StreamSolver::count_excess(std::optional<LimitExcess> excess, Word number,
                                bool is_refused) noexcept {
  if (!excess) return;
  excess->item = number;
  excess->is_refused = is_refused;
  board_->write_excess(summary_.exceeding++, *excess);
  const auto ratio = [&](const LimitExcess& of) {
    const MotionLimits& limits = curve_.window().options().limits;
    return core::ratio_of(limits, of.kind, of.dimension, of.value, of.limit);
  };
  const auto worst = published_->worst_excess();
  if (!is_refused && (!worst || ratio(*excess) > ratio(*worst))) {
    board_->write_worst_excess(*excess);
  }
}

void StreamSolver::handle_replacement(Word number) noexcept {
  // A replacement is never too late. A stop is a revision of its own, which is committed sooner
  // than a full batch.
  const bool rests = can_rest() && begins_at_rest(item_.time, *step_.held_from, step_.settled_until,
                                                  live_->settle_ahead);
  const Time t = rests ? *step_.held_from : time_of_cut(item_.time);
  const bool has_begun = curve_.has_begun();  // else there is nothing to replace
  if (has_begun && !is_time_in_range(t)) {
    return refuse_replacement(number, Refusal::too_far_apart);
  }
  // Waypoints that begin a curve together are taken together, too.
  const bool is_begin = !has_begun && live_ && item_.count > 0 && number + 1 < step_.available;
  if (is_begin && time_refusal(ring_->time(number + 1))) {
    return refuse_replacement(number, Refusal::past);
  }
  ++summary_.controls;
  // The replacement and its waypoints are one revision, as far as the board has room.
  const bool may_follow = number >= unsound_.until;
  const Word followers = may_follow ? std::min<Word>(item_.count, board_->capacity() / 2) : 0;
  step_.batch_limit = is_stop(item_) ? 0 : step_.batch_limit + followers;
  if (!has_begun) return;
  outcomes_.note_in_force(number, is_stop(item_) ? OutcomeWay::stop : OutcomeWay::entry, t);
  // A stop after another one changes nothing.
  if (is_stop(item_) && curve_.is_stop() && t >= curve_.plan().newest_time()) return;
  const RunBegin how{.blend = std::clamp(item_.blend, Time::zero(), intervals_.most),
                     .has_waypoints = !is_stop(item_),
                     .is_from_rest = rests};
  begin_run(t, how);
}

/// Refuses a replacement and, in the same revision, its waypoints. Otherwise a solver that takes
/// over would take them as appended waypoints.
void StreamSolver::refuse_replacement(Word number, Refusal reason) noexcept {
  refuse(number, reason);
  const Word end =
      summary_.consumed + std::min<Word>(item_.count, step_.available - summary_.consumed);
  while (summary_.consumed < end) refuse(summary_.consumed++, reason);
}

/// Takes the pieces of a law's plan, which the planner has appended in this step. The state at the
/// cut determines the curve through them.
void StreamSolver::handle_plan(Word number) noexcept {
  const Time t = item_.time;
  const Word pieces = Word{1} + item_.count;
  core::RateCurve plan(t, {});
  if (const auto reason = read_plan(number, plan)) {
    refuse(number, *reason);
    // What follows in the ring of a law are the other pieces.
    while (planner_ != nullptr && summary_.consumed < step_.available) {
      refuse(summary_.consumed++, *reason);
    }
    return;
  }
  summary_.consumed = number + pieces;
  summary_.controls += pieces;
  curve_.begin_run(t, {});
  if (curve_.is_damaged()) return;
  const Instant cut = curve_.plan().origin();
  core::LawPath path({.time = t,
                      .position = cut.position[0],
                      .rate = cut.velocity[0],
                      .slope = cut.acceleration[0]});
  for (const core::RatePiece& piece : plan.pieces()) path.add_piece(piece.end_rate, piece.length);
  path.add_line();
  // Looks for the entry onto the first waypoint before the newer ones push it out of the window.
  for (const Waypoint& waypoint : path.waypoints()) {
    curve_.append(waypoint, number);
    curve_.advance_search(step_.settled_until, step_.keep, false, step_.tries);
  }
  summary_.starved = false;
  summary_.newest_time = path.waypoints().back().time;
}

/// Reads the rates and lengths of a plan whose first piece has been copied; or why it is refused.
std::optional<Refusal> StreamSolver::read_plan(Word number, core::RateCurve& plan) noexcept {
  const Time t = item_.time;
  const Word pieces = Word{1} + item_.count;
  const bool is_plan = planner_ != nullptr && item_.place == 0 && curve_.has_begun() &&
                       pieces <= core::RateCurve::kMostPieces && number + pieces <= step_.available;
  if (!is_plan) return Refusal::unknown_kind;
  if (t < step_.settled_until || !is_time_in_range(t) || t < curve_.earliest_cut()) {
    return Refusal::too_late;
  }
  for (Word i = 0; i < pieces; ++i) {
    if (i > 0) ring_->copy(number + i, item_);
    if (item_.kind != ItemKind::rate || item_.place != i) return Refusal::unknown_kind;
    const auto piece = piece_of(item_.waypoint());
    if (!piece) return Refusal::not_finite;
    plan.add(piece->end_rate, piece->length);
  }
  const bool is_in_range = is_time_in_range(plan.end() + core::kLawLine);
  return is_in_range ? std::nullopt : std::optional(Refusal::too_far_apart);
}

void StreamSolver::handle_start_state(Word number) noexcept {
  const Waypoint state = item_.waypoint();
  if (curve_.has_begun()) return refuse(number, Refusal::already_started);
  if (!is_finite(state)) return refuse(number, Refusal::not_finite);
  if (!curve_.kinds().takes(state.position)) return refuse(number, Refusal::zero_quaternion);
  if (state.velocity.empty() || state.acceleration.empty()) {
    return refuse(number, Refusal::lacks_derivatives);
  }
  if (!is_time_in_range(state.time)) return refuse(number, Refusal::too_far_apart);
  // One that comes late begins as early as possible.
  const Time begin = live_ ? std::max(state.time, step_.settled_until) : state.time;
  ++summary_.controls;
  outcomes_.note_in_force(number, OutcomeWay::entry, begin);
  curve_.begin({.time = begin,
                .position = state.position,
                .velocity = state.velocity,
                .acceleration = state.acceleration});
  summary_.newest_time = begin;
}

void StreamSolver::handle_finish(Word number) noexcept {
  end_.kind = item_.condition;
  end_.value.clear();
  const std::size_t dimensions = ring_->dimensions();
  if (!is_online(item_.condition)) {
    return refuse(number, Refusal::unknown_kind);
  }
  const bool is_velocity = item_.condition == ConditionKind::velocity;
  if (is_velocity || item_.condition == ConditionKind::acceleration) {
    const auto values =
        std::span(item_.values).subspan((is_velocity ? 1 : 2) * dimensions, dimensions);
    if (!is_finite(values)) return refuse(number, Refusal::not_finite);
    end_.value.assign(values.begin(), values.end());
  }
  step_.is_postponed =
      curve_.has_begun() && !curve_.finish(end_, step_.settled_until, step_.keep, step_.tries);
  if (step_.is_postponed) return;
  const bool stops =
      curve_.plan().ending() == EndKind::stopped || curve_.plan().ending() == EndKind::in_stop;
  if (stops && !summary_.starved) count_excess(curve_.stop_excess(), number, false);
  summary_.finished = true;
  summary_.end_kind = static_cast<Word>(curve_.plan().ending());
  summary_.end_item = number;
  summary_.end_lateness = curve_.end_lateness();
  ++summary_.controls;
}

void StreamSolver::refuse(Word number, Refusal reason) noexcept {
  board_->write_refusal(
      summary_.refused++,
      {.item = number, .reason = reason, .slot = static_cast<std::uint8_t>(summary_.holder)});
  ++summary_.reasons[static_cast<std::size_t>(reason)];
  has_refused_ = true;
}

/// Records what this revision, which takes the items from `first` on, has decided. Not of a law,
/// whose runs have no waypoints of a ring.
void StreamSolver::note_outcomes(const RunProgress& now, Word first) noexcept {
  outcomes_.advance(now);
  if (summary_.finished && summary_.end_item >= first) note_end(now);
  outcomes_.put(summary_);
}

void StreamSolver::note_end(const RunProgress& now) noexcept {
  const EndKind kind = curve_.plan().ending();
  const Time rest = summary_.newest > 0 ? curve_.end_of_motion() : step_.settled_until;
  outcomes_.end(now, {.kind = kind, .rest = rest, .item = summary_.end_item});
  if (kind != EndKind::slowed) return;
  Word newer = 1;
  while (newer < kOutcomesKept &&
         outcomes_.note_at_end(now, newer, published_->time_hint(summary_.newest - newer))) {
    ++newer;
  }
}

}  // namespace splinecast::ipc
