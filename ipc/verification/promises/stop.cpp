#include "ipc/verification/promises/stop.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "core/limits/check.hpp"
#include "core/limits/limit_of.hpp"

namespace splinecast::ipc {
namespace {

/// By how much a solver may choose otherwise than this program would, as a share of a length or of
/// a limit.
constexpr double kSlack = 1e-6;

Time longer(Time length) noexcept {
  return from_seconds(to_seconds(length) * (1 + kSlack)) + Time(1);
}
Time shorter(Time length) noexcept {
  return std::max(from_seconds(to_seconds(length) * (1 - kSlack)) - Time(1), Time(1));
}

/// Whether a stop passes a bound of a dimension with a limit of acceleration.
bool passes_bound(const MotionLimits& limits, const Instant& from, Time length) noexcept {
  for (std::size_t d = 0; d < from.velocity.size(); ++d) {
    if (core::limit_of(limits.acceleration, d) == 0) continue;
    if (core::stop_passes_bound(limits, from, d, length)) return true;
  }
  return false;
}

/// Whether the largest ratio of a segment to a limit of acceleration or jerk is at most 1.
bool keeps_limits(const MotionLimits& limits, const core::Segment& stop) noexcept {
  // A stop keeps the limits of each component of a quaternion, not those of its rotation.
  const auto worst = core::worst_excesses(limits, nullptr, core::part_of(stop));
  const auto ratio = [&](LimitKind kind) { return worst[static_cast<std::size_t>(kind)].ratio; };
  return ratio(LimitKind::acceleration) <= 1 + kSlack && ratio(LimitKind::jerk) <= 1 + kSlack;
}

/// The longest time that the limits may have needed. A stop records the acceleration with which it
/// begins: the limit, if the motion decelerated beyond the limit, and then it needs longer.
Time longest_needed(const MotionLimits& limits, const Instant& from) noexcept {
  std::array<double, kMaxDimensions> values;  // NOLINT(*-member-init)
  const auto acceleration = std::span(values).first(from.velocity.size());
  for (std::size_t d = 0; d < acceleration.size(); ++d) {
    const double a = from.acceleration[d];
    const bool is_at_limit = std::abs(a) >= core::limit_of(limits.acceleration, d) * (1 - kSlack);
    acceleration[d] = is_at_limit ? 2 * a : a;
  }
  return core::least_stop_time(limits, {from.time, from.position, from.velocity, acceleration});
}

}  // namespace

Time former_stop_time(const core::StopRules& rules, const Instant& from) noexcept {
  const MotionLimits& limits = rules.limits;
  constexpr double kLongest = 1e6;  // s
  double longest = 0;
  for (std::size_t d = 0; d < from.velocity.size(); ++d) {
    const double v = from.velocity[d];
    const double a = from.acceleration[d];
    const double a_max = core::limit_of(limits.acceleration, d);
    if (a_max > 0) {
      const double beta = v * a < 0 ? std::abs(a) / a_max : 0;
      const double q = beta > 1 ? 0 : std::sqrt(1 - beta);
      const double share = beta > 1 ? 3 : 3 / ((1 + q) * (2 - q));
      longest = std::max(longest, share * std::abs(v) / a_max);
    }
    const double j_max = core::limit_of(limits.jerk, d);
    if (j_max > 0) longest = std::max(longest, std::sqrt(6 * std::abs(v) / j_max));
  }
  return std::max(rules.stop_time, from_seconds(std::min(longest, kLongest)));
}

std::string_view broken_promise(const core::StopRules& rules, const Instant& from,
                                const core::Segment& stop, StopPart part) noexcept {
  const MotionLimits& limits = rules.limits;
  if (!keeps_limits(limits, stop)) return "limits of a stop";
  if (part == StopPart::remainder) return {};
  const Time length = stop.right - stop.left;
  const Time least = longest_needed(limits, from);
  const Time most = std::max(rules.stop_time, least);
  if (length > longer(most)) return "length of a stop: too long";
  if (passes_bound(limits, from, length) && passes_bound(limits, from, shorter(length)) &&
      length > longer(least)) {
    return "bounds of a stop";
  }
  const bool is_shortened = longer(length) < most;
  if (is_shortened && !passes_bound(limits, from, longer(length))) {
    return "length of a stop: too short";
  }
  return {};
}

}  // namespace splinecast::ipc
