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

Time stop_time_within(const MotionLimits& limits, Time least, std::span<const double> velocity,
                      std::span<const double> acceleration) noexcept {
  if (limits.acceleration.empty() && limits.jerk.empty()) return least;
  double longest = 0;
  for (std::size_t d = 0; d < velocity.size(); ++d) {
    const double a_max = limit_of(limits.acceleration, d);
    if (a_max > 0) {
      longest = std::max(longest, seconds_within(velocity[d], acceleration[d], a_max));
    }
    const double j_max = limit_of(limits.jerk, d);
    if (j_max > 0) longest = std::max(longest, seconds_within_jerk(velocity[d], j_max));
  }
  longest = std::min(longest, kLongest);
  return std::max(least, from_seconds(longest));
}

Time build_stop_within(const MotionLimits& limits, Time least, const Instant& from,
                       Segment& out) noexcept {
  const Time length = stop_time_within(limits, least, from.velocity, from.acceleration);
  build_stop(from.time, length, from.position, from.velocity, from.acceleration, out);
  return length;
}

}  // namespace splinecast::core
