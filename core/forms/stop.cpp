#include "core/forms/stop.hpp"

#include <algorithm>
#include <cmath>

#include "core/limits/limit_of.hpp"
#include "core/simd/clones.hpp"
#include "core/simd/lanes.hpp"

namespace splinecast::core {
namespace {

/// Longest stop in seconds: limits that need a longer one are unreasonable.
constexpr double kLongest = 1e6;

/// The acceleration clamped between 0 and the steepest deceleration without reversal.
template <typename Lane>
[[gnu::always_inline]] inline Lane clamped(Lane v, Lane a, double seconds) noexcept {
  const Lane zero{};
  const Lane steepest = -3.0 * v / seconds;
  const Lane low = steepest < zero ? steepest : zero;
  const Lane high = steepest > zero ? steepest : zero;
  const Lane raised = a < low ? low : a;
  return raised > high ? high : raised;
}

/// Shortest time in which a stop respects an acceleration limit A. With β = |a₀|/A, where a₀
/// decelerates, and q = √(1 − β): the deceleration of a stop of length T is largest at T·q/(1+q),
/// and is A there if T = 3/((1 + q)(2 − q))·|v|/A.
double seconds_within(double v, double a, double limit) noexcept {
  const double beta = v * a < 0 ? std::abs(a) / limit : 0;
  if (beta > 1) return 3 * std::abs(v) / limit;
  const double q = std::sqrt(1 - beta);
  return 3 / ((1 + q) * (2 - q)) * std::abs(v) / limit;
}

/// Shortest time in which a stop respects a jerk limit: its jerk is largest at an end, and at most
/// 6|v|/T² for any initial acceleration.
double seconds_within_jerk(double v, double limit) noexcept {
  return std::sqrt(6 * std::abs(v) / limit);
}

}  // namespace

double stop_acceleration(double velocity, double acceleration, double seconds) noexcept {
  return clamped(velocity, acceleration, seconds);
}

SPLINECAST_VECTOR_CLONES
void build_stop(Time from, Time stop_time, std::span<const double> position,
                std::span<const double> velocity, std::span<const double> acceleration,
                Segment& out) noexcept {
  const std::size_t dimensions = position.size();
  const double rest_after = to_seconds(stop_time);
  out.left = from;
  out.right = from + stop_time;
  out.order = kMaxOrder;
  out.kind = SegmentKind::stop;
  for_overlapping_lanes(dimensions, [&](auto lane, std::size_t first) {
    using Lane = typename decltype(lane)::type;
    const auto v = load_lane<Lane>(velocity.data() + first);
    const Lane a = clamped(v, load_lane<Lane>(acceleration.data() + first), rest_after);
    const Lane jerk_scale = v / (rest_after * rest_after);
    const Lane snap_scale = a / rest_after;
    double* const c = out.coefficients.data() + first;
    store_lane(c, load_lane<Lane>(position.data() + first));
    store_lane(c + dimensions, v);
    store_lane<Lane>(c + 2 * dimensions, a / 2.0);
    store_lane<Lane>(c + 3 * dimensions, -jerk_scale - 2.0 * snap_scale / 3.0);
    store_lane<Lane>(c + 4 * dimensions, (2.0 * jerk_scale + snap_scale) / (4 * rest_after));
    store_lane<Lane>(c + 5 * dimensions, Lane{});
  });
}

Time least_stop_time(const MotionLimits& limits, const Instant& from) noexcept {
  double longest = 0;
  for (std::size_t d = 0; d < from.velocity.size(); ++d) {
    const double a_max = limit_of(limits.acceleration, d);
    if (a_max > 0) {
      longest = std::max(longest, seconds_within(from.velocity[d], from.acceleration[d], a_max));
    }
    const double j_max = limit_of(limits.jerk, d);
    if (j_max > 0) longest = std::max(longest, seconds_within_jerk(from.velocity[d], j_max));
  }
  return from_seconds(std::min(longest, kLongest));
}

double stop_position(const Instant& from, std::size_t d, Time length) noexcept {
  const double seconds = to_seconds(length);
  const double v = from.velocity[d];
  const double a = stop_acceleration(v, from.acceleration[d], seconds);
  return from.position[d] + seconds * (v / 2 + seconds * a / 12);
}

bool stop_passes_bound(const MotionLimits& limits, const Instant& from, std::size_t d,
                       Time length) noexcept {
  const double v = from.velocity[d];
  if (v > 0 && !limits.upper.empty()) return stop_position(from, d, length) > limits.upper[d];
  return v < 0 && !limits.lower.empty() && stop_position(from, d, length) < limits.lower[d];
}

namespace {

/// The longest time from `least` to `most` after which a dimension rests within its bounds; `least`
/// if no such time exists.
Time longest_within_bound(const MotionLimits& limits, const Instant& from, std::size_t d,
                          Time least, Time most) noexcept {
  if (!stop_passes_bound(limits, from, d, most)) return most;
  while (most - least > Time(1)) {
    const Time middle = least + (most - least) / 2;
    (stop_passes_bound(limits, from, d, middle) ? most : least) = middle;
  }
  return least;
}

}  // namespace

Time stop_time_within(const StopRules& rules, const Instant& from) noexcept {
  const MotionLimits& limits = rules.limits;
  if (limits.acceleration.empty() && limits.jerk.empty()) return rules.stop_time;
  const Time least = std::max(least_stop_time(limits, from), Time(1));
  Time length = std::max(rules.stop_time, least);
  if (limits.lower.empty() && limits.upper.empty()) return length;
  for (std::size_t d = 0; d < from.velocity.size(); ++d) {
    if (limit_of(limits.acceleration, d) == 0) continue;
    length = longest_within_bound(limits, from, d, least, length);
  }
  return length;
}

Time build_stop_within(const StopRules& rules, const Instant& from, Segment& out) noexcept {
  const Time length = stop_time_within(rules, from);
  build_stop(from.time, length, from.position, from.velocity, from.acceleration, out);
  return length;
}

}  // namespace splinecast::core
