#include "core/laws/rate_plan.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

namespace splinecast::core {
namespace {

/// Rounding of a comparison. A curve that has exceeded a bound by rounding may continue to do so.
constexpr double kRounding = 1e-12;

constexpr Time kLongestRise = std::chrono::hours(2);

/// A time in nanoseconds, rounded down; at least `least`.
Time at_least(Time least, double nanoseconds) noexcept {
  constexpr double kMost = 4e18;
  return std::max(least, Time(static_cast<Time::rep>(std::min(nanoseconds, kMost))));
}

Time scaled(Time time, double by) noexcept {
  return at_least(Time(1), by * static_cast<double>(time.count()));
}

/// The longest duration in which a rate that falls with this slope can fall by `change` and be
/// monotone: the cubic's slope is then at most 3 times that of its chord (Fritsch and Carlson
/// 1980).
Time longest_fall(double change, double slope) noexcept {
  if (slope >= 0) return Time::max();
  return at_least(Time::zero(), 3e9 * change / -slope);
}

/// The rate after a slope has been brought to 0 monotonically.
double flattened(const RateState& from, Time length) noexcept {
  return std::max(from.rate + from.slope * to_seconds(length) / 3, 0.0);
}

/// One search for a plan.
class RatePlanner {
 public:
  RatePlanner(const RateCurve& law, Time t, std::span<const RateCurve> bounds, double target,
              Time ramp) noexcept
      : law_(law), t_(t), bounds_(bounds), target_(target), ramp_(ramp), from_(law.at(t)) {}

  [[nodiscard]] std::optional<RateCurve> plan() noexcept {
    const bool is_within = passes(law_);
    if (is_within && law_.last_rate() == target_) return std::nullopt;
    std::optional<RateCurve> found;
    if (from_.slope > 0) {
      found = flatten_a_rise();
      if (!found && target_ < from_.rate) found = fall(start());
    } else if (target_ < from_.rate &&
               longest_fall(from_.rate - target_, from_.slope) >= kShortestPiece) {
      found = fall(start());
    } else if (from_.slope < 0) {
      found = flatten_a_fall();
    } else if (target_ > from_.rate) {
      found = rise(start());
    }
    if (found || is_within) return found;
    RateCurve last = start();
    last.add(std::min(target_, from_.rate), kShortestPiece);
    return last;
  }

 private:
  [[nodiscard]] RateCurve start() const noexcept { return {t_, from_}; }

  /// Whether a curve exceeds no bound by more than the law does already.
  [[nodiscard]] bool passes(const RateCurve& curve) const noexcept;

  /// A curve with a piece that falls to the target added: the longest of some that passes, or two
  /// pieces by way of the end of a bound.
  [[nodiscard]] std::optional<RateCurve> fall(const RateCurve& before) const noexcept {
    std::optional<RateCurve> best = fall_directly(before);
    if (before.pieces().size() + 2 > RateCurve::kMostPieces) return best;
    for (const RateCurve& bound : bounds_) {
      const double by = bound.last_rate();
      const Time length = bound.rest(before.end());
      const double change = before.last_rate() - by;
      if (by <= target_ || change <= 0 || length < kShortestPiece) continue;
      if (before.pieces().empty() && length > longest_fall(change, from_.slope)) continue;
      RateCurve first = before;
      first.add(by, length);
      if (best && first.steepest() >= best->steepest()) continue;
      const auto both = fall_directly(first);
      if (both && (!best || both->steepest() < best->steepest())) best = both;
    }
    return best;
  }

  [[nodiscard]] std::optional<RateCurve> fall_directly(const RateCurve& before) const noexcept {
    const bool is_first = before.pieces().empty();
    Time length = kShortestPiece;
    for (const RateCurve& bound : bounds_) length = std::max(length, bound.rest(before.end()));
    if (is_first) {
      length = std::min(length, longest_fall(from_.rate - target_, from_.slope));
    }
    for (;; length = next_shorter(length, before.end())) {
      RateCurve candidate = before;
      candidate.add(target_, length);
      if (passes(candidate)) return candidate;
      if (length <= kShortestPiece) return std::nullopt;
    }
  }

  /// Four fifths of a length, or the longest rest of a ramp that is between the two.
  [[nodiscard]] Time next_shorter(Time length, Time begin) const noexcept {
    constexpr double kShorter = 0.8;
    Time next = std::max(scaled(length, kShorter), kShortestPiece);
    for (const RateCurve& bound : bounds_) {
      const Time rest = bound.rest(begin);
      if (rest < length) next = std::max(next, rest);
    }
    return next;
  }

  /// A curve with a piece that rises to the target added: the ramp, or a longer one.
  [[nodiscard]] std::optional<RateCurve> rise(const RateCurve& before) const noexcept {
    constexpr double kLonger = 1.25;
    for (Time length = ramp_; length <= kLongestRise; length = scaled(length, kLonger)) {
      RateCurve candidate = before;
      candidate.add(target_, length);
      if (passes(candidate)) return candidate;
    }
    return std::nullopt;
  }

  /// A curve that continues from the end of a flattening to the target.
  [[nodiscard]] std::optional<RateCurve> continued(const RateCurve& flat) const noexcept {
    if (flat.last_rate() > target_) return fall(flat);
    if (flat.last_rate() < target_) {
      if (auto risen = rise(flat)) return risen;
    }
    return passes(flat) ? std::optional(flat) : std::nullopt;
  }

  [[nodiscard]] std::optional<RateCurve> flatten_a_rise() const noexcept {
    const Time rest = law_.part_at(t_).piece->end() - t_;
    const Time longest = std::min(scaled(ramp_, 1.0 / 4), rest);
    for (Time length = longest; length >= kShortestPiece; length = scaled(length, 1.0 / 2)) {
      RateCurve flat = start();
      flat.add(flattened(from_, length), length);
      if (auto found = continued(flat)) return found;
    }
    return std::nullopt;
  }

  [[nodiscard]] std::optional<RateCurve> flatten_a_fall() const noexcept {
    constexpr double kLonger = 1.5;
    const Time longest = longest_fall(from_.rate, from_.slope);
    for (Time length = std::min(scaled(ramp_, 1.0 / 4), longest); length >= kShortestPiece;
         length = std::min(scaled(length, kLonger), longest)) {
      RateCurve flat = start();
      flat.add(flattened(from_, length), length);
      if (auto found = continued(flat)) return found;
      if (length == longest) break;
    }
    return std::nullopt;
  }

  const RateCurve& law_;
  Time t_;
  std::span<const RateCurve> bounds_;
  double target_;
  Time ramp_;
  RateState from_;
};

bool RatePlanner::passes(const RateCurve& curve) const noexcept {
  return std::ranges::all_of(bounds_, [&](const RateCurve& bound) {
    const double already = std::max(from_.rate - bound.at(t_).rate, 0.0);
    return largest_excess(curve, bound, t_) <= already + kRounding;
  });
}

}  // namespace

RateCurve bound_after(const RateCurve& bound, Time t, const RateRequest& request) noexcept {
  const RateCurve::Part part = bound.part_at(t);
  const RateState from = part.at(t);
  if (from.slope > 0) {
    RateCurve after(t, from);
    const Time length = std::max(std::min(scaled(request.ramp, 1.0 / 4), part.end - t), Time(1));
    after.add(flattened(from, length), length);
    after.add(request.rate, request.ramp);
    return after;
  }
  if (request.rate >= from.rate) {
    RateCurve after(t, {from.rate, 0});
    if (request.rate > from.rate) after.add(request.rate, request.ramp);
    return after;
  }
  RateCurve after(t, from);
  const Time longest = longest_fall(from.rate - request.rate, from.slope);
  after.add(request.rate, std::max(std::min(request.ramp, longest), Time(1)));
  return after;
}

Time plan_begin(const RateCurve& law, Time t) noexcept {
  const RateCurve::Part part = law.part_at(t);
  return part.piece != nullptr && part.end - t < kShortestPiece ? part.end : t;
}

RateCurve ramp_alone(Time t, const RateState& from, const RateRequest& request) noexcept {
  RateCurve before(t, from);
  if (from.slope != 0) {
    const Time flatten =
        std::min(scaled(request.ramp, 1.0 / 4), longest_fall(from.rate, from.slope));
    before.add(flattened(from, flatten), std::max(flatten, kShortestPiece));
  }
  const RateCurve bound = bound_after(before, t, request);
  const auto planned = plan_rate(before, t, std::span(&bound, 1), request.rate, request.ramp);
  return planned.value_or(before);
}

std::optional<RateCurve> plan_rate(const RateCurve& law, Time t, std::span<const RateCurve> bounds,
                                   double target, Time ramp) noexcept {
  return RatePlanner(law, t, bounds, target, ramp).plan();
}

}  // namespace splinecast::core
