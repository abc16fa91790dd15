#include "core/motion/entry_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/forms/knot_segment.hpp"
#include "core/limits/extremes.hpp"
#include "core/limits/limit_of.hpp"

namespace splinecast::core {
namespace {

/// Whether the velocity at the newest knot is an estimate until the next knot is known.
bool is_guess(const SlidingWindow& target) noexcept {
  return !target.options().interpolant.method->needs_velocity();
}

}  // namespace

EntrySearch::EntrySearch(std::size_t dimensions, DimensionKinds kinds)
    : kinds_(std::move(kinds)),
      end_state_(dimensions),
      rest_(dimensions),
      entry_(dimensions),
      later_(dimensions),
      extrapolation_(dimensions) {
  allowed_.velocity.resize(dimensions);
  allowed_.acceleration.resize(dimensions);
  granted_.velocity.resize(dimensions);
  granted_.acceleration.resize(dimensions);
  for (auto* const bounds : {&allowed_.jerk, &allowed_.lower, &allowed_.upper}) {
    bounds->reserve(dimensions);
  }
}

void EntrySearch::restart(std::size_t first) noexcept {
  next_knot_ = first;
  former_end_.reset();
  duration_ = 0;
  is_longest_ = false;
  fallback_knot_.reset();
  std::ranges::fill(granted_.velocity, 0.0);
  std::ranges::fill(granted_.acceleration, 0.0);
}

EntrySearch::Outcome EntrySearch::search(const SlidingWindow& target, const Instant& from,
                                         const EntryRules& rules, int& tries) noexcept {
  knows_after_ = false;
  const Outcome at_knots = search_knots(target, from, rules, tries);
  if (at_knots != Outcome::none || !rules.may_end_ahead) return at_knots;
  const Outcome ahead = search_ahead(target, from, rules, tries);
  const bool falls_back = ahead == Outcome::none && rules.falls_back;
  return falls_back ? fall_back(target, from, rules) : ahead;
}

EntrySearch::Outcome EntrySearch::search_knots(const SlidingWindow& target, const Instant& from,
                                               const EntryRules& rules, int& tries) noexcept {
  next_knot_ = std::max(next_knot_, target.oldest_segment());
  const std::size_t newer = std::max<std::size_t>(rules.newer, is_guess(target) ? 1 : 0);
  for (; next_knot_ + newer < target.knots(); ++next_knot_) {
    if (target.time(next_knot_) - from.time < rules.least) continue;
    end_ = end_at_knot(target, next_knot_, end_state_);
    const Verdict verdict = judge(from, rules, tries);
    if (verdict == Verdict::untried) return Outcome::more;
    if (verdict == Verdict::exceeds) continue;
    if (keeps_after(target, rules)) return Outcome::found;
    if (!fallback_knot_) fallback_knot_ = next_knot_;
  }
  return Outcome::none;
}

EntrySearch::Outcome EntrySearch::search_ahead(const SlidingWindow& target, const Instant& from,
                                               const EntryRules& rules, int& tries) noexcept {
  extrapolation_.begin(target);
  const Time to_newest = target.time(target.knots() - 1) - from.time;
  const bool guesses = is_guess(target);
  while (const auto duration = next_duration(from.time, to_newest, guesses, rules.least)) {
    end_ = end_ahead(target, extrapolation_, from.time + *duration, end_state_);
    const double before = duration_;
    const bool was_longest = is_longest_;
    duration_ = to_seconds(*duration);
    is_longest_ = *duration >= kLongest;
    const Verdict verdict = judge(from, rules, tries);
    if (verdict == Verdict::untried) {
      duration_ = before;
      is_longest_ = was_longest;
      return Outcome::more;
    }
    if (verdict == Verdict::passes && keeps_ahead(*rules.limits)) return Outcome::found;
    if (is_longest_ && passes_at_last(from, rules) && keeps_ahead(*rules.limits)) {
      return Outcome::found;
    }
  }
  return Outcome::none;
}

/// The next duration: first that to the newest knot, if the search did not try this knot, then
/// longer ones; nothing after the longest one. A recomputed entry may end at the same time as
/// before; otherwise its end would move later with every waypoint.
std::optional<Time> EntrySearch::next_duration(Time from, Time to_newest, bool tries_newest,
                                               Time shortest) noexcept {
  if (is_longest_) return std::nullopt;
  if (duration_ == 0 && tries_newest && to_newest >= shortest && to_newest > Time::zero()) {
    return to_newest;
  }
  shortest = std::max(shortest, to_newest);
  const double least = std::max(to_seconds(shortest), duration_);
  // Below 10 ns the factor alone would not change a duration.
  const Time longer = std::max(from_seconds(least * kGrowth), from_seconds(least) + Time(1));
  const Time next = shortest < kLongest ? std::min(longer, kLongest) : longer;
  const bool comes_first =
      former_end_ && *former_end_ - from > from_seconds(least) && *former_end_ - from < next;
  return comes_first ? *former_end_ - from : next;
}

/// Builds the entry to the first knot for which the entry itself respects the limits. Returns
/// `none` if there is no such knot, or if the entry no longer respects them.
EntrySearch::Outcome EntrySearch::fall_back(const SlidingWindow& target, const Instant& from,
                                            const EntryRules& rules) noexcept {
  if (!fallback_knot_ || *fallback_knot_ < target.oldest_segment()) return Outcome::none;
  if (target.time(*fallback_knot_) - from.time < rules.least) return Outcome::none;
  end_ = end_at_knot(target, *fallback_knot_, end_state_);
  if (ends_outside(*rules.limits)) return Outcome::none;
  allow(from, rules);
  return passes(from) ? Outcome::found : Outcome::none;
}

EntrySearch::Outcome EntrySearch::search_rest(const Instant& rest, const Instant& from,
                                              const EntryRules& rules, Time longest,
                                              int& tries) noexcept {
  const Time own = rest.time - from.time;
  end_ = {};
  end_.state = rest;
  if (ends_outside(*rules.limits)) return Outcome::none;
  EntryRules between = rules;
  between.stays_between = true;
  if (duration_ == 0 && own >= rules.least) {
    const Verdict verdict = judge(from, between, tries);
    if (verdict == Verdict::passes) return Outcome::found;
    if (verdict == Verdict::untried) return Outcome::more;
  }
  constexpr double kShortest = 1e-6;  // s
  duration_ = std::max({duration_, to_seconds(own), to_seconds(rules.least), kShortest});
  while (duration_ < to_seconds(longest)) {
    end_.state.time = from.time + from_seconds(duration_ * kGrowth);
    const Verdict verdict = judge(from, between, tries);
    if (verdict == Verdict::passes) return Outcome::found;
    if (verdict == Verdict::untried) return Outcome::more;
    if (duration_ > to_seconds(kLongest) && passes_at_last(from, between)) return Outcome::found;
    duration_ *= kGrowth;
  }
  return Outcome::none;
}

/// Tries the current end. Does not build an entry that cannot pass.
EntrySearch::Verdict EntrySearch::judge(const Instant& from, const EntryRules& rules,
                                        int& tries) noexcept {
  if (ends_outside(*rules.limits)) return Verdict::exceeds;
  allow(from, rules);
  if (is_out_of_reach(from) || leaves_early(from)) return Verdict::exceeds;
  if (tries <= 0) return Verdict::untried;
  --tries;
  return passes(from) ? Verdict::passes : Verdict::exceeds;
}

/// Whether all segments after the knot at which the entry ends respect the limits, and the stop
/// after the newest knot if the rules compare it. The first call of a search finds the last segment
/// that exceeds a limit; the next calls use this result.
bool EntrySearch::keeps_after(const SlidingWindow& target, const EntryRules& rules) noexcept {
  if (!knows_after_) {
    knows_after_ = true;
    last_exceeding_.reset();
    target.segment(target.knots() - 1, later_);
    stop_exceeds_ = rules.checks_stop &&
                    excess_of_stop(target, later_, StopBounds::limited, rest_.ref().position);
    for (std::size_t i = target.knots() - 1; i > *end_.knot && !last_exceeding_; --i) {
      target.segment(i - 1, later_);
      if (!keeps_within(rules.of_path(), &kinds_, later_)) last_exceeding_ = i - 1;
    }
  }
  return !stop_exceeds_ && (!last_exceeding_ || *last_exceeding_ < *end_.knot);
}

/// Whether the rest of the line respects the limits of rotations, whose angular velocity changes
/// along a straight line.
bool EntrySearch::rotations_keep_line(const MotionLimits& limits) noexcept {
  if (kinds_.quaternions().empty() || end_.state.time >= extrapolation_.line_end()) return true;
  const Instant to = extrapolation_.line_end_state();
  build_segment(SegmentForm::cubic,
                {end_.state.time, end_.state.position, end_.state.velocity, {}, {}},
                {to.time, to.position, to.velocity, {}, {}}, later_);
  return keeps_within(limits, &kinds_, later_);
}

/// Whether the rest of the line and the stop segment respect the position bounds. They respect all
/// other limits by construction, but for rotations.
bool EntrySearch::keeps_ahead(const MotionLimits& limits) noexcept {
  if (!rotations_keep_line(limits)) return false;
  if (limits.lower.empty() && limits.upper.empty()) return true;
  // Each dimension moves in one direction only, so that its position at rest is the farthest.
  extrapolation_.state_at(extrapolation_.rest(), rest_.ref());
  const auto position = rest_.position();
  for (std::size_t d = 0; d < position.size(); ++d) {
    if (!limits.lower.empty() && position[d] < limits.lower[d]) return false;
    if (!limits.upper.empty() && position[d] > limits.upper[d]) return false;
  }
  return true;
}

bool EntrySearch::passes(const Instant& from) noexcept {
  build_entry(from, end_.state, entry_);
  return keeps_within(allowed_, &kinds_, entry_) && keeps_length(kinds_, entry_);
}

/// The same without the shown limits: for entries of at least kLongest.
bool EntrySearch::passes_at_last(const Instant& from, const EntryRules& rules) noexcept {
  if (rules.shown == nullptr || ends_outside(*rules.limits)) return false;
  EntryRules given = rules;
  given.shown = nullptr;
  allow(from, given);
  return passes(from);
}

namespace {

double peak_acceleration(const Segment& segment, std::size_t d) noexcept {
  const SegmentPart part = part_of(segment);
  return std::abs(range_of(part.order, part.coefficients, part.dimensions, d, 2, part.from, part.to)
                      .largest()
                      .value);
}

/// The mean acceleration over the first three waypoints; 0 if there are fewer.
double shown_at_start(const SlidingWindow& target, std::size_t d) noexcept {
  constexpr std::size_t kWaypoints = 3;
  if (target.knots() < kWaypoints) return 0;
  const auto slope = [&](std::size_t i) {
    return (target.knot(i + 1).waypoint[d] - target.knot(i).waypoint[d]) /
           to_seconds(target.time(i + 1) - target.time(i));
  };
  return std::abs(slope(1) - slope(0)) * 2 / to_seconds(target.time(2) - target.time(0));
}

}  // namespace

bool EntrySearch::keeps_start(const SlidingWindow& target, const EntryRules& rules) noexcept {
  const bool shows_motion = target.knots() >= kStartFades + 2;
  auto& peaks = allowed_.acceleration;
  for (std::size_t d = 0; d < peaks.size(); ++d) {
    peaks[d] = shows_motion ? 0 : shown_at_start(target, d);
  }
  for (std::size_t i = 0; i + 1 < target.knots(); ++i) {
    Segment& segment = i == 0 ? entry_ : later_;
    target.segment(i, segment);
    if (!keeps_within(rules.of_path(), &kinds_, segment)) return false;
    if (i < kStartFades) continue;
    for (std::size_t d = 0; d < peaks.size(); ++d) {
      peaks[d] = std::max(peaks[d], peak_acceleration(segment, d));
    }
  }
  if (rules.shown == nullptr) return true;
  for (std::size_t d = 0; d < peaks.size(); ++d) {
    if (limit_of(rules.limits->acceleration, d) > 0) continue;
    const double shown = std::max(3 * peaks[d], rules.shown->acceleration[d]);
    if (peak_acceleration(entry_, d) > shown) return false;
  }
  return true;
}

}  // namespace splinecast::core
