#include "core/forms/stop.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/limits/for_all.hpp"
#include "core/limits/limit_of.hpp"
#include "core/limits/rotation_bounds.hpp"
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

/// Writes the coefficients of a stop of `seconds` > 0.
[[gnu::always_inline]] inline void write_stop(std::span<const double> position,
                                              std::span<const double> velocity,
                                              std::span<const double> acceleration, double seconds,
                                              double* out) noexcept {
  const std::size_t dimensions = position.size();
  for_overlapping_lanes(dimensions, [&](auto lane, std::size_t first) {
    using Lane = typename decltype(lane)::type;
    const auto v = load_lane<Lane>(velocity.data() + first);
    const Lane a = clamped(v, load_lane<Lane>(acceleration.data() + first), seconds);
    const Lane jerk_scale = v / (seconds * seconds);
    const Lane snap_scale = a / seconds;
    double* const c = out + first;
    store_lane(c, load_lane<Lane>(position.data() + first));
    store_lane(c + dimensions, v);
    store_lane<Lane>(c + 2 * dimensions, a / 2.0);
    store_lane<Lane>(c + 3 * dimensions, -jerk_scale - 2.0 * snap_scale / 3.0);
    store_lane<Lane>(c + 4 * dimensions, (2.0 * jerk_scale + snap_scale) / (4 * seconds));
    store_lane<Lane>(c + 5 * dimensions, Lane{});
  });
}

SPLINECAST_VECTOR_CLONES
void build_stop(Time from, Time stop_length, std::span<const double> position,
                std::span<const double> velocity, std::span<const double> acceleration,
                Segment& out) noexcept {
  out.left = from;
  out.right = from + stop_length;
  out.order = kMaxOrder;
  out.kind = SegmentKind::stop;
  write_stop(position, velocity, acceleration, to_seconds(stop_length), out.coefficients.data());
}

namespace {

struct Products {
  double along = 0;    ///< of velocity and acceleration
  double squares = 0;  ///< of the velocity
};

Products products(const QuaternionDimensions& quaternion, std::span<const double> velocity,
                  std::span<const double> acceleration) noexcept {
  Products sum;
  for (std::size_t d = quaternion.first; d < quaternion.first + kQuaternionSize; ++d) {
    sum.along += velocity[d] * acceleration[d];
    sum.squares += velocity[d] * velocity[d];
  }
  return sum;
}

bool has_limits(const MotionLimits& limits, const QuaternionDimensions& quaternion) noexcept {
  return limit_of(limits.acceleration, quaternion.first) > 0 ||
         limit_of(limits.jerk, quaternion.first) > 0;
}

/// Whether a quaternion that stops in this time keeps its limits.
bool rotation_keeps(const MotionLimits& limits, const QuaternionDimensions& quaternion,
                    const Instant& from, Time length) noexcept {
  std::array<double, kMaxOrder * kQuaternionSize> coefficients;  // NOLINT(*-member-init)
  const auto of = [&](std::span<const double> values) {
    return values.subspan(quaternion.first, kQuaternionSize);
  };
  write_stop(of(from.position), of(from.velocity), of(from.acceleration), to_seconds(length),
             coefficients.data());
  const RotationBounds bounds({.order = kMaxOrder,
                               .coefficients = coefficients,
                               .dimensions = kQuaternionSize,
                               .from = 0,
                               .to = to_seconds(length)},
                              {.first = 0, .w_first = quaternion.w_first});
  const double a_max = limit_of(limits.acceleration, quaternion.first);
  const double j_max = limit_of(limits.jerk, quaternion.first);
  return (a_max == 0 || bounds.keeps(2, a_max)) && (j_max == 0 || bounds.keeps(3, j_max));
}

bool rotations_keep(const StopRules& rules, const Instant& from, Time length) noexcept {
  return std::ranges::all_of(rules.kinds.quaternions(), [&](const QuaternionDimensions& q) {
    return !has_limits(rules.limits, q) || rotation_keeps(rules.limits, q, from, length);
  });
}

/// The first time from `least` on, in steps of a share of it, in which all rotations keep their
/// limits; `least` if none does.
Time lengthened(const StopRules& rules, const Instant& from, Time least) noexcept {
  constexpr int kTries = 24;
  constexpr double kGrowth = 1.1;
  Time length = least;
  for (int i = 0; i < kTries; ++i) {
    if (rotations_keep(rules, from, length)) return length;
    length = from_seconds(to_seconds(length) * kGrowth) + Time(1);
  }
  return least;
}

}  // namespace

void align_rotations(const DimensionKinds& kinds, std::span<const double> velocity,
                     std::span<double> acceleration) noexcept {
  for (const QuaternionDimensions& quaternion : kinds.quaternions()) {
    const auto [along, squares] = products(quaternion, velocity, acceleration);
    const double share = along < 0 && squares > 0 ? along / squares : 0;
    for (std::size_t d = quaternion.first; d < quaternion.first + kQuaternionSize; ++d) {
      // −0 becomes 0, as when a curve is evaluated.
      acceleration[d] = share * velocity[d] + 0.0;
    }
  }
}

Time least_stop_time(const MotionLimits& limits, const DimensionKinds& kinds,
                     const Instant& from) noexcept {
  double longest = 0;
  const auto take = [&](std::size_t d, double v, double a) {
    const double a_max = limit_of(limits.acceleration, d);
    if (a_max > 0) longest = std::max(longest, seconds_within(v, a, a_max));
    const double j_max = limit_of(limits.jerk, d);
    if (j_max > 0) longest = std::max(longest, seconds_within_jerk(v, j_max));
  };
  const auto take_one = [&](std::size_t d) {
    take(d, from.velocity[d], from.acceleration[d]);
    return true;
  };
  const auto take_rotation = [&](const QuaternionDimensions& quaternion) {
    const std::size_t first = quaternion.first;
    // A unit quaternion turns at twice its velocity.
    const auto [along, squares] = products(quaternion, from.velocity, from.acceleration);
    const double speed = std::sqrt(squares);
    take(first, 2 * speed, speed > 0 ? 2 * along / speed : 0);
    // An acceleration that is not aligned is clamped in each component.
    const double a_max = limit_of(limits.acceleration, first);
    for (std::size_t d = first; a_max > 0 && d < first + kQuaternionSize; ++d) {
      longest = std::max(longest, seconds_within(from.velocity[d], from.acceleration[d], a_max));
    }
    return true;
  };
  (void)for_all(kinds.quaternions(), from.velocity.size(), take_one, take_rotation);
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
  if (limits.acceleration.empty() && limits.jerk.empty()) return rules.stop_length;
  const Time estimate = std::max(least_stop_time(limits, rules.kinds, from), Time(1));
  const Time least = lengthened(rules, from, estimate);
  Time length = std::max(rules.stop_length, least);
  // The rotation of a longer stop may exceed its limits: it has turned farther from the line.
  if (length > least && !rotations_keep(rules, from, length)) length = least;
  if (limits.lower.empty() && limits.upper.empty()) return length;
  for (std::size_t d = 0; d < from.velocity.size(); ++d) {
    if (limit_of(limits.acceleration, d) == 0) continue;
    length = longest_within_bound(limits, from, d, least, length);
  }
  return length;
}

Time build_stop_within(const StopRules& rules, const Instant& from, Segment& out) noexcept {
  std::array<double, kMaxDimensions> values;  // NOLINT(*-member-init)
  const auto acceleration = std::span(values).first(from.acceleration.size());
  std::ranges::copy(from.acceleration, acceleration.begin());
  align_rotations(rules.kinds, from.velocity, acceleration);
  const Instant begin{from.time, from.position, from.velocity, acceleration};
  const Time length = stop_time_within(rules, begin);
  build_stop(from.time, length, from.position, from.velocity, acceleration, out);
  return length;
}

}  // namespace splinecast::core
