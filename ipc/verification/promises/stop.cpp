#include "ipc/verification/promises/stop.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "core/limits/extremes.hpp"
#include "core/limits/for_all.hpp"
#include "core/limits/limit_of.hpp"

namespace splinecast::ipc {
namespace {

/// By how much a solver may choose otherwise than this program would, as a share of a length or of
/// a limit.
constexpr double kSlack = 2e-6;

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

/// Whether a stop keeps the limits of acceleration and jerk of each dimension that is not one of a
/// quaternion. Some rotations are so fast that no stop keeps their limits.
bool keeps_limits(const core::StopRules& rules, const core::Segment& stop) noexcept {
  const core::SegmentPart part = core::part_of(stop);
  const auto keeps = [&](std::size_t d, int derivative, double limit) {
    if (limit == 0) return true;
    const auto range = core::range_of(part.order, part.coefficients, part.dimensions, d, derivative,
                                      part.from, part.to);
    return std::abs(range.largest().value) <= limit * (1 + kSlack);
  };
  return core::for_all(
      rules.kinds.quaternions(), part.dimensions,
      [&](std::size_t d) {
        return keeps(d, 2, core::limit_of(rules.limits.acceleration, d)) &&
               keeps(d, 3, core::limit_of(rules.limits.jerk, d));
      },
      [](const QuaternionDimensions&) { return true; });
}

/// The longest time that the limits may have needed. A stop records the acceleration with which it
/// begins: the limit, if the motion decelerated beyond the limit, and then it needs longer.
Time longest_needed(const core::StopRules& rules, const Instant& from) noexcept {
  std::array<double, kMaxDimensions> values;  // NOLINT(*-member-init)
  const auto acceleration = std::span(values).first(from.velocity.size());
  for (std::size_t d = 0; d < acceleration.size(); ++d) {
    const double a = from.acceleration[d];
    const bool is_at_limit =
        std::abs(a) >= core::limit_of(rules.limits.acceleration, d) * (1 - kSlack);
    acceleration[d] = is_at_limit ? 2 * a : a;
  }
  return core::least_stop_time(rules.limits, rules.kinds,
                               {from.time, from.position, from.velocity, acceleration});
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
  return std::max(rules.stop_length, from_seconds(std::min(longest, kLongest)));
}

std::string_view broken_promise(const core::StopRules& rules, const Instant& from,
                                const core::Segment& stop, StopPart part) noexcept {
  const MotionLimits& limits = rules.limits;
  const Time length = stop.right - stop.left;
  if (!keeps_limits(rules, stop)) return "limits of a stop";
  // The length of a rotation's stop is found in steps, from the acceleration before it is clamped.
  if (part == StopPart::remainder || !rules.kinds.quaternions().empty()) return {};
  const Time least = longest_needed(rules, from);
  const Time most = std::max(rules.stop_length, least);
  if (length > longer(most)) return "length of a stop: too long";
  if (passes_bound(limits, from, length) && passes_bound(limits, from, shorter(length)) &&
      length > longer(least)) {
    return "bounds of a stop";
  }
  const bool is_shortened =
      part == StopPart::whole && longer(length) < core::stop_time_within(rules, from);
  if (is_shortened && !passes_bound(limits, from, longer(length))) {
    return "length of a stop: too short";
  }
  return {};
}

}  // namespace splinecast::ipc
