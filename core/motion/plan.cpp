#include "core/motion/plan.hpp"

#include <algorithm>
#include <array>

#include "core/forms/instant.hpp"
#include "core/forms/stop.hpp"
#include "core/limits/limit_of.hpp"

namespace splinecast::core {
namespace {

constexpr std::array<double, kMaxDimensions> kZeros{};

}  // namespace

Plan::Plan(std::size_t dimensions, const WindowOptions& options, bool counts_unmet)
    : window_(dimensions, options),
      counts_unmet_(counts_unmet),
      origin_state_(dimensions),
      entry_end_(dimensions),
      moved_(3 * dimensions) {}

Instant Plan::origin() const noexcept {
  return instant_of(origin_.value_or(Time{}), origin_state_);
}

Time Plan::newest_time() const noexcept {
  if (window_.knots() > 0) return window_.time(window_.knots() - 1);
  return origin_.value_or(Time{});
}

std::span<const double> Plan::newest_position() const noexcept {
  if (window_.knots() > 0) return window_.knot(window_.knots() - 1).waypoint;
  return window_.is_later_run() ? origin_state_.position() : std::span<const double>{};
}

Waypoint Plan::nearest(const Waypoint& given) noexcept {
  if (window_.kinds().all_linear()) return given;
  const auto copy = [this](std::size_t part, std::span<const double> from) {
    const auto to = std::span(moved_).subspan(part * window_.dimensions(), from.size());
    std::ranges::copy(from, to.begin());
    return to;
  };
  const WaypointValues values{.position = copy(0, given.position),
                              .velocity = copy(1, given.velocity),
                              .acceleration = copy(2, given.acceleration)};
  window_.kinds().continue_from(newest_position(), values);
  return {.time = given.time,
          .position = values.position,
          .velocity = values.velocity,
          .acceleration = values.acceleration};
}

Time Plan::settled_until() const noexcept {
  const std::size_t knots = window_.knots();
  if (knots == 0 || !is_on_target()) return origin_.value_or(Time{});
  return window_.time(std::min(window_.settled_segments(), knots - 1));
}

Time Plan::stop_after_entry(const EnteringAhead& ahead) const noexcept {
  const AfterEntry& after = ahead.after;
  const Time length = after.stop_length();
  if (length <= after.rest - after.stop_begin()) return length;
  return std::max(length, least_stop_time(window_.limits_at_largest_rate(), window_.kinds(),
                                          {after.end, entry_end_.position(), entry_end_.velocity(),
                                           entry_end_.acceleration()}));
}

Instant Plan::stop_begin(const EnteringAhead& ahead, std::span<double> scratch) const noexcept {
  const AfterEntry& after = ahead.after;
  if (!after.has_line()) return instant_of(after.end, entry_end_);
  after.write_line_end(entry_end_.position(), entry_end_.velocity(), scratch);
  return {after.line_end, scratch, entry_end_.velocity(), std::span(kZeros).first(scratch.size())};
}

bool Plan::starts_from_halt() const noexcept {
  const WindowOptions& options = window_.options();
  return !window_.is_later_run() && options.held_before_start &&
         options.start.kind == ConditionKind::halt;
}

bool Plan::is_start_open() const noexcept {
  const bool may_change = is<OnTarget>(end_) || is<Starting>(end_);
  return may_change && starts_from_halt() && window_.knots() >= 2 &&
         window_.oldest_segment() == 0 && window_.frozen_knots() == 0;
}

void Plan::restore(const PlanState& state, std::span<const Knot> knots) noexcept {
  end_ = state.end;
  ended_.reset();
  met_ = state.met;
  unmet_ = state.unmet;
  origin_.reset();
  if (state.origin) set_origin(*state.origin);
  if (state.entry_end) copy_values(*state.entry_end, entry_end_);
  blend_until_ = state.blend_until;
  unmet_since_ = state.unmet_since;
  refused_until_ = state.refused_until;
  const std::size_t first = state.knots - knots.size();
  if (state.is_later_run) {
    window_.restore_run(first, knots);
  } else {
    window_.restore(first, knots);
  }
  window_.freeze_knots(state.frozen);
  passed_before_ = state.passed_over - std::min(state.passed_over, passed_by_entry());
  const auto* const ahead = std::get_if<EnteringAhead>(&end_);
  const std::size_t used = ahead != nullptr ? ahead->known : unmet_;
  set_searching(!has_given_up() && window_.knots() > used);
}

void Plan::copy_from(const Plan& other, std::span<Knot> scratch) noexcept {
  window_.copy_from(other.window_, scratch);
  counts_unmet_ = other.counts_unmet_;
  end_ = other.end_;
  ended_ = other.ended_;
  origin_ = other.origin_;
  origin_state_ = other.origin_state_;
  entry_end_ = other.entry_end_;
  met_ = other.met_;
  unmet_ = other.unmet_;
  passed_before_ = other.passed_before_;
  blend_until_ = other.blend_until_;
  unmet_since_ = other.unmet_since_;
  refused_until_ = other.refused_until_;
}

void Plan::set_origin(const Instant& state) noexcept {
  origin_ = state.time;
  copy_values(state, origin_state_);
  const StateRef origin = origin_state_.ref();
  clamp_acceleration(window_.limits_at_largest_rate(), window_.kinds(), origin.velocity,
                     origin.acceleration);
}

void Plan::begin(const Instant& state) noexcept {
  window_.begin_run();
  wait_for_entry(0);
  set_origin(state);
}

void Plan::cut(const Instant& state, Time blend) noexcept {
  if (auto* const ahead = std::get_if<EnteringAhead>(&end_)) {
    ahead->ends_at_known = ahead->ends_at_known && state.time >= ahead->after.end;
  }
  passed_before_ += passed_by_entry();
  begin(state);
  blend_until_ = state.time + blend;
}

bool Plan::append(const Waypoint& waypoint) noexcept {
  window_.append(waypoint);
  if (!may_enter(end_)) return false;
  const bool begins = !is_searching(end_);
  set_searching(true);
  if (unmet_since_ == Time::max()) restart_unmet_since();
  return begins;
}

Plan::Frozen Plan::freeze(Time t) noexcept {
  const std::size_t knots = window_.knots();
  const auto* const entering = std::get_if<Entering>(&end_);
  if (entering != nullptr && t >= entering->end) {
    passed_before_ += passed_by_entry();
    end_ = OnTarget{};
    unmet_ = met_;
    origin_.reset();
  }
  if (meets_known(t)) restart_unmet_since();
  if (is<OnTarget>(end_) && knots > 0) {
    window_.freeze(t);
    // The newest knot is frozen: readers follow the stop after it.
    if (t < window_.time(knots - 1)) return Frozen::nothing_to_do;
    wait_for_entry(knots);
    return Frozen::left_target;
  }
  const bool may_search = is<Waiting>(end_) && !is_searching(end_) && !has_given_up();
  if (!may_search || knots <= unmet_ || t >= newest_time()) return Frozen::nothing_to_do;
  // The entry would now begin later in the stop, in another state: candidates that failed before
  // may now keep the limits.
  set_searching(true);
  return Frozen::searches_again;
}

/// Notes that an entry ahead that ends at the newest waypoint it knew has ended there by t, and
/// that the curve has met this waypoint. Returns whether it has.
bool Plan::meets_known(Time t) noexcept {
  auto* const ahead = std::get_if<EnteringAhead>(&end_);
  if (ahead == nullptr || !ahead->ends_at_known || t < ahead->after.end) return false;
  passed_before_ += ahead->known - 1 - unmet_;
  unmet_ = ahead->known;
  ahead->ends_at_known = false;
  return true;
}

/// Makes the end of the curve final: only an entry can lead to knot `unmet` or a later one. Those
/// before it are met or passed over.
void Plan::wait_for_entry(std::size_t unmet) noexcept {
  end_ = Waiting{};
  met_ = window_.knots();
  unmet_ = unmet;
  origin_.reset();
  restart_unmet_since();
}

/// Sets unmet_since() to the time of the first unmet waypoint, if it is counted and there is one,
/// and takes waypoints again.
void Plan::restart_unmet_since() noexcept {
  refused_until_ = unmet_since_ = Time::max();
  if (!counts_unmet_ || unmet_ >= window_.knots()) return;
  unmet_since_ = unmet_ >= window_.oldest_segment() ? window_.time(unmet_) : newest_time();
}

void Plan::rest_at_start() noexcept {
  const Knot first = window_.knot(0);
  const auto zeros = std::span(kZeros).first(window_.dimensions());
  end_ = Starting{};
  met_ = window_.knots();
  unmet_ = 1;
  set_origin({first.time, first.position, zeros, zeros});
}

void Plan::start_on_target() noexcept {
  end_ = OnTarget{};
  met_ = unmet_ = 0;
  origin_.reset();
}

void Plan::start_by_entry() noexcept {
  end_ = Waiting{.is_searching = true};
  restart_unmet_since();
}

void Plan::leave_target_at(std::size_t knot) noexcept {
  passed_before_ += passed_by_entry();
  window_.freeze_knots(knot + 1);
  wait_for_entry(knot + 1);
}

void Plan::enter(const EntryEnd& end, const std::optional<Instant>& from) noexcept {
  if (from) {
    (void)meets_known(from->time);
    set_origin(*from);
  }
  if (end.knot) {
    end_ = Entering{.end = end.state.time, .known = end.known};
    met_ = *end.knot;
    window_.freeze_knots(met_ + 1);
    refused_until_ = unmet_since_ = Time::max();
    std::ranges::copy(end.state.acceleration, entry_end_.ref().acceleration.begin());
    return;
  }
  end_ = EnteringAhead{.after = {.end = end.state.time, .line_end = end.line_end, .rest = end.rest},
                       .known = end.known,
                       .ends_at_known = end.state.time == window_.time(end.known - 1)};
  met_ = window_.knots();
  copy_values(end.state, entry_end_);
}

void Plan::resume_at(Time t) noexcept {
  refused_until_ = Time::max();
  unmet_since_ = t;
}

void Plan::end_on_target(const Condition& end) noexcept {
  window_.finish(end);
  ended_ = Ended{EndKind::as_requested};
}

void Plan::end_at_newest() noexcept {
  (void)meets_known(Time::max());
  mark_newest_met();
  ended_ = Ended{EndKind::as_requested};
}

/// Marks the newest waypoint as met by a curve that does not reach it on the target.
void Plan::mark_newest_met() noexcept {
  const std::size_t last = window_.knots() - 1;
  if (is<OnTarget>(end_)) unmet_ = last;
  met_ = std::max(unmet_, last);
}

void Plan::end_by_entry(Time rest, const std::optional<Instant>& from) noexcept {
  if (from) {
    (void)meets_known(from->time);
    set_origin(*from);
  }
  ended_ = Ended{EndKind::entered, rest};
  const auto newest = window_.knot(window_.knots() - 1).position;
  std::ranges::copy(newest, entry_end_.ref().position.begin());
  mark_newest_met();
}

void Plan::end_by_entry_from_target(Time rest, const Instant& from, std::size_t knot) noexcept {
  passed_before_ += passed_by_entry();
  end_ = OnTarget{};
  end_by_entry(rest, from);
  unmet_ = knot;
}

/// Waypoints that the open entry passes over.
std::size_t Plan::passed_by_entry() const noexcept {
  if (is<Starting>(end_)) return 0;  // not decided yet
  const bool ends_at_newest = ending() == EndKind::as_requested || ending() == EndKind::entered;
  const bool has_met = is_on_target() || ends_at_newest;
  const std::size_t end = has_met ? met_ : window_.knots();
  const std::size_t over = end - std::min(end, unmet_);
  const auto* const ahead = std::get_if<EnteringAhead>(&end_);
  const bool meets_end = !has_met && ahead != nullptr && ahead->ends_at_known;
  return over - (meets_end ? 1 : 0);
}

}  // namespace splinecast::core
