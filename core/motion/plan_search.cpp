#include "core/motion/plan_search.hpp"

#include <algorithm>
#include <cmath>

#include "core/forms/entry.hpp"
#include "core/forms/stop.hpp"
#include "core/limits/limit_of.hpp"

namespace splinecast::core {
namespace {

bool is_zero(std::span<const double> values) noexcept {
  return std::ranges::all_of(values, [](double value) { return value == 0; });
}

}  // namespace

PlanSearch::PlanSearch(std::size_t dimensions, const WindowOptions& window,
                       const EntryOptions& options)
    : options_(options),
      has_limits_(!window.limits.empty()),
      search_(dimensions, window.kinds),
      trial_(dimensions, window),
      reach_(dimensions),
      end_limits_(trial_.window().limits_at_largest_rate()),
      values_(dimensions) {
  end_limits_.acceleration.resize(dimensions);
}

void PlanSearch::restart(const Plan& plan) noexcept {
  const auto* const ahead = std::get_if<EnteringAhead>(&plan.end());
  if (ahead == nullptr) return search_.restart(plan.unmet());
  const State& end = plan.entry_end();
  search_.restart(plan.unmet(), plan.origin(),
                  {ahead->after.end, end.position(), end.velocity(), end.acceleration()});
}

EntryRules PlanSearch::rules(const Plan& plan, const EntryBegin& from) const noexcept {
  const Time until = plan.blend_until();
  const Time begin = from.state.time;
  const bool blends = until > begin;  // only in a run that began with a cut
  return {.limits = &plan.window().limits_at_largest_rate(),
          .path_limits = &plan.window().options().limits,
          .shown = from.shown,
          .least = blends ? std::max(options_.least_entry, until - begin) : options_.least_entry,
          .reach = &reach_,
          .falls_back = !options_.keeps_limits,
          .checks_stop = options_.checks_stops};
}

PlanSearch::Outcome PlanSearch::search(const Plan& plan, const EntryBegin& from, bool is_last,
                                       int& tries) noexcept {
  EntryRules how = rules(plan, from);
  how.may_end_ahead = is_last && options_.is_live;
  how.newer = how.may_end_ahead ? 0 : plan.window().options().settle;
  return search_.search(plan.window(), from.state, how, tries);
}

bool PlanSearch::search_before_end(const Plan& plan, const EntryBegin& from) noexcept {
  EntryRules how = rules(plan, from);
  how.newer = 1;
  int tries = static_cast<int>(plan.window().knots() - plan.window().oldest_segment());
  search_.restart(plan.unmet());
  return search_.search(plan.window(), from.state, how, tries) == Outcome::found;
}

PlanSearch::Outcome PlanSearch::search_with(const Plan& plan, const Waypoint& waypoint,
                                            std::size_t frozen, const EntryBegin& from,
                                            int& tries) noexcept {
  trial_.begin(plan.window());
  trial_.window().freeze_knots(std::max(frozen, plan.window().frozen_knots()));
  trial_.window().append(waypoint);
  EntryRules how = rules(plan, from);
  how.may_end_ahead = true;
  return search_.search(trial_.window(), from.state, how, tries);
}

PlanSearch::Outcome PlanSearch::search_rest(const Plan& plan, const EntryBegin& from, Time longest,
                                            int& tries) noexcept {
  const Knot newest = plan.window().knot(plan.window().knots() - 1);
  std::ranges::fill(values_, 0.0);
  return search_.search_rest({newest.time, newest.position, values_, values_}, from.state,
                             rules(plan, from), longest, tries);
}

Time PlanSearch::longest_end(const Plan& plan, Time from, Time rest) const noexcept {
  constexpr double kLongestWithinLimits = 60;  // s
  const MotionLimits& limits = plan.window().limits_at_largest_rate();
  const auto newest = plan.window().knot(plan.window().knots() - 1).position;
  double seconds = to_seconds(EntrySearch::kLongest);
  for (std::size_t d = 0; d < newest.size(); ++d) {
    const double x = newest[d];
    const double way =
        std::max(std::abs(reach_.least()[d] - x), std::abs(reach_.greatest()[d] - x));
    seconds = std::max(
        seconds, seconds_from_rest(way, limit_of(limits.velocity, d),
                                   limit_of(limits.acceleration, d), limit_of(limits.jerk, d)));
  }
  return std::max(rest - from, Time::zero()) +
         from_seconds(std::min(seconds, kLongestWithinLimits));
}

bool PlanSearch::rests_at_newest(const Plan& plan, const Instant& from) const noexcept {
  const auto newest = plan.window().knot(plan.window().knots() - 1).position;
  return std::ranges::equal(from.position, newest) && is_zero(from.velocity) &&
         is_zero(from.acceleration) && std::ranges::equal(reach_.least(), newest) &&
         std::ranges::equal(reach_.greatest(), newest);
}

bool PlanSearch::keeps_start(const Plan& plan, const MotionLimits* shown) noexcept {
  return search_.keeps_start(plan.window(), rules(plan, {plan.origin(), shown}));
}

bool PlanSearch::awaits_start_check(const Plan& plan) const noexcept {
  return plan.is_start_open() && plan.window().knots() < plan.window().options().settle + 2;
}

/// The first segment that is not frozen and that the published curve may still follow. A curve that
/// is not on the target can follow only segments after its next entry, which begins at `settled` or
/// later.
std::size_t PlanSearch::first_open(const Plan& plan, Time settled) const noexcept {
  const SlidingWindow& window = plan.window();
  const std::size_t frozen = window.frozen_knots();
  std::size_t first =
      std::max({plan.is_on_target() ? plan.met() : plan.unmet(),
                frozen - std::min<std::size_t>(frozen, 1), window.oldest_segment()});
  if (plan.is_on_target()) return first;
  const Time begin = plan.has_origin() ? std::max(settled, plan.origin().time) : settled;
  const Time earliest = std::max(begin + options_.least_entry, plan.blend_until());
  while (first < window.knots() && window.time(first) < earliest) ++first;
  return first;
}

/// The first segment to be compared when a waypoint is appended. Excludes the first kStartFades
/// segments of a stream that starts at rest: keeps_start() compares them with the limits. On a live
/// stream they are compared after that, unless an entry from rest may still pass over them.
std::size_t PlanSearch::first_compared(const Plan& plan, Time settled,
                                       bool begins_stream) const noexcept {
  const bool is_undecided =
      awaits_start_check(plan) || (plan.window().knots() < 2 && !options_.keeps_limits);
  const bool may_pass_over = is_undecided || (!plan.is_on_target() && begins_stream);
  const bool excludes_start = plan.starts_from_halt() && (!options_.is_live || may_pass_over);
  return std::max(first_open(plan, settled), excludes_start ? kStartFades : 0);
}

std::optional<TimedExcess> PlanSearch::find_excess(const Plan& plan, const Waypoint& waypoint,
                                                   Time settled, bool begins_stream) noexcept {
  trial_.begin(plan.window());
  trial_.window().append(waypoint);
  const bool all_count = options_.keeps_limits;
  const auto worst = trial_.worst_excess(first_compared(plan, settled, begins_stream),
                                         all_count ? nullptr : &plan.window());
  if (worst || !options_.checks_stops) return worst;
  const auto excess = trial_.excess_of_newest_stop();
  return excess && excess->time >= settled ? excess : std::nullopt;
}

bool PlanSearch::keeps_limits_with(const Plan& plan, const Condition& end, Time settled,
                                   const MotionLimits& shown) noexcept {
  if (!options_.is_live) return true;
  search_.write_accelerations(plan.window().limits_at_largest_rate(), shown,
                              end_limits_.acceleration);
  trial_.begin(plan.window());
  SlidingWindow& ended = trial_.window();
  ended.finish(end);
  return is_zero(ended.knot(ended.knots() - 1).velocity) &&
         trial_.exceeds_no_more(end_limits_, first_open(plan, settled), plan.window());
}

void PlanSearch::build_stop_at_end(const Plan& plan, Segment& out) noexcept {
  const SlidingWindow& window = plan.window();
  const Knot knot = window.knot(window.knots() - 1);
  const Time usual = window.write_stop(values_);
  const MotionLimits& given = window.limits_at_largest_rate();
  const bool has_limit =
      std::ranges::any_of(given.acceleration, [](double limit) { return limit > 0; });
  const Instant from{knot.time, knot.position, knot.velocity, values_};
  const Time shortest = std::max(stop_time_within({end_limits_, window.kinds(), Time(1)}, from),
                                 stop_time_within({given, window.kinds(), Time(1)}, from));
  build_stop(knot.time, has_limit ? std::min(usual, shortest) : usual, knot.position, knot.velocity,
             values_, out);
}

}  // namespace splinecast::core
