#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

#include "core/limits/extremes.hpp"
#include "core/limits/limit_of.hpp"
#include "core/motion/entry_search.hpp"

/// What an entry may have: velocities, accelerations and positions.
namespace splinecast::core {
namespace {

/// Least allowed value that follows from the shown motion: smaller values cannot be distinguished
/// from rounding.
constexpr double kLeastAllowed = 1e-9;

}  // namespace

/// Calls `write` with the velocity and the acceleration of each dimension; for a quaternion once,
/// with the bounds |ω| ≤ 2|q̇| and |α| ≤ 2|q̈| + 4|q̇|² over all four components.
void EntrySearch::write_of_dimensions(const auto& velocity_of, const auto& acceleration_of,
                                      const auto& write) const noexcept {
  std::size_t d = 0;
  for (const QuaternionDimensions& q : kinds_.quaternions()) {
    for (; d < q.first; ++d) write(d, velocity_of(d), acceleration_of(d));
    double velocity = 0;
    double acceleration = 0;
    for (; d < q.first + kQuaternionSize; ++d) {
      velocity = std::hypot(velocity, velocity_of(d));
      acceleration = std::hypot(acceleration, acceleration_of(d));
    }
    write(q.first, 2 * velocity, 2 * acceleration + 4 * velocity * velocity);
  }
  for (; d < allowed_.velocity.size(); ++d) write(d, velocity_of(d), acceleration_of(d));
}

void EntrySearch::restart(std::size_t first, const Instant& from, const Instant& end) noexcept {
  restart(first);
  former_end_ = end.time;
  build_entry(from, end, later_);
  constexpr double kSlack = 1 + 1e-9;
  const auto peak = [&](std::size_t d, int derivative) {
    const SegmentPart part = part_of(later_);
    const auto range =
        range_of(part.order, part.coefficients, part.dimensions, d, derivative, part.from, part.to);
    return std::abs(range.largest().value) * kSlack;
  };
  write_of_dimensions([&](std::size_t d) { return peak(d, 1); },
                      [&](std::size_t d) { return peak(d, 2); },
                      [&](std::size_t d, double velocity, double acceleration) {
                        granted_.velocity[d] = velocity;
                        granted_.acceleration[d] = acceleration;
                      });
}

/// Sets the allowed velocities and accelerations of the entry: the limit, or the velocity at the
/// start of the entry if that exceeds the limit. Without a limit, see `allow_shown`.
void EntrySearch::allow(const Instant& from, const EntryRules& rules) noexcept {
  allowed_.jerk = rules.limits->jerk;
  for (std::size_t d = 0; d < from.position.size(); ++d) {
    const double v_max = limit_of(rules.limits->velocity, d);
    allowed_.velocity[d] = v_max > 0 ? std::max(v_max, std::abs(from.velocity[d])) : 0;
    allowed_.acceleration[d] = limit_of(rules.limits->acceleration, d);
  }
  allow_positions(from, rules);
  if (rules.shown != nullptr) allow_shown(from, rules);
}

/// Sets the positions that the entry may have: the bounds or, with `stays_between`, those of its
/// two ends; and those of `reach`.
void EntrySearch::allow_positions(const Instant& from, const EntryRules& rules) noexcept {
  if (rules.stays_between) {
    const auto& to = end_.state.position;
    allowed_.lower.resize(to.size());
    allowed_.upper.resize(to.size());
    for (std::size_t d = 0; d < to.size(); ++d) {
      std::tie(allowed_.lower[d], allowed_.upper[d]) = std::minmax(from.position[d], to[d]);
    }
  } else {
    allowed_.lower = rules.limits->lower;
    allowed_.upper = rules.limits->upper;
  }
  if (rules.reach == nullptr) return;
  for (std::size_t d = 0; d < allowed_.lower.size(); ++d) {
    allowed_.lower[d] = std::min(allowed_.lower[d], rules.reach->least()[d]);
  }
  for (std::size_t d = 0; d < allowed_.upper.size(); ++d) {
    allowed_.upper[d] = std::max(allowed_.upper[d], rules.reach->greatest()[d]);
  }
}

void EntrySearch::write_accelerations(const MotionLimits& limits, const MotionLimits& shown,
                                      std::span<double> acceleration) const noexcept {
  for (std::size_t d = 0; d < acceleration.size(); ++d) {
    acceleration[d] = limit_of(limits.acceleration, d);
  }
  write_of_dimensions([&](std::size_t d) { return shown.velocity[d]; },
                      [&](std::size_t d) { return shown.acceleration[d]; },
                      [&](std::size_t d, double, double largest) {
                        if (acceleration[d] == 0)
                          acceleration[d] = std::max(largest, kLeastAllowed);
                      });
}

void EntrySearch::allow_shown(const Instant& from, const EntryRules& rules) noexcept {
  const Instant& to = end_.state;
  const auto allow_dimension = [&](std::size_t d, double velocity, double acceleration) {
    if (allowed_.acceleration[d] > 0) return;
    if (allowed_.velocity[d] == 0) {
      allowed_.velocity[d] = std::max({velocity, granted_.velocity[d], kLeastAllowed});
    }
    allowed_.acceleration[d] = std::max({acceleration, granted_.acceleration[d], kLeastAllowed});
  };
  // From rest to rest over a distance x in 1 s, the peak velocity is 1.875 x and the peak
  // acceleration 5.77 x.
  const auto velocity_of = [&](std::size_t d) {
    const double way = std::abs(to.position[d] - from.position[d]);
    return std::max(
        {rules.shown->velocity[d], std::abs(from.velocity[d]), std::abs(to.velocity[d]), 2 * way});
  };
  const auto acceleration_of = [&](std::size_t d) {
    const double way = std::abs(to.position[d] - from.position[d]);
    return std::max({rules.shown->acceleration[d], std::abs(from.acceleration[d]),
                     std::abs(to.acceleration[d]), 6 * way});
  };
  write_of_dimensions(velocity_of, acceleration_of, allow_dimension);
}

/// Whether the end of the entry is outside a bound.
bool EntrySearch::ends_outside(const MotionLimits& limits) const noexcept {
  const auto& end = end_.state.position;
  const auto rounding = [](double x, double bound) {
    return kExtremeRounding * std::max(std::abs(x), std::abs(bound));
  };
  for (std::size_t d = 0; d < limits.lower.size(); ++d) {
    if (end[d] < limits.lower[d] && end[d] < limits.lower[d] - rounding(end[d], limits.lower[d])) {
      return true;
    }
  }
  for (std::size_t d = 0; d < limits.upper.size(); ++d) {
    if (end[d] > limits.upper[d] && end[d] > limits.upper[d] + rounding(end[d], limits.upper[d])) {
      return true;
    }
  }
  return false;
}

/// Whether the entry leaves the allowed positions after a third of its duration, where it has gone
/// almost as far as its velocity at the begin can lead it.
bool EntrySearch::leaves_early(const Instant& from) const noexcept {
  constexpr double kRounding = 1e-12;
  const double duration = to_seconds(end_.state.time - from.time);
  const auto quaternions = kinds_.quaternions();
  const auto is_rotation = [&](std::size_t d) {
    return std::ranges::any_of(
        quaternions, [d](const QuaternionDimensions& q) { return d - q.first < kQuaternionSize; });
  };
  for (std::size_t d = 0; d < std::max(allowed_.lower.size(), allowed_.upper.size()); ++d) {
    if (is_rotation(d)) continue;
    const Instant& to = end_.state;
    const double way = to.position[d] - from.position[d];
    // The quintic's terms of its values at both ends, at 1/3.
    const double x =
        from.position[d] + 17.0 / 81 * way +
        duration * (16.0 / 81 * from.velocity[d] - 2.0 / 27 * to.velocity[d]) +
        duration * duration * (4.0 / 243 * from.acceleration[d] + 2.0 / 243 * to.acceleration[d]);
    const double slack = kRounding * (std::abs(from.position[d]) + std::abs(x) + std::abs(way));
    if (!allowed_.lower.empty() && x < allowed_.lower[d] - slack) return true;
    if (!allowed_.upper.empty() && x > allowed_.upper[d] + slack) return true;
  }
  return false;
}

/// Whether no motion from `from` to the end of the entry can respect the allowed values. With the
/// duration T, the mean acceleration is Δv/T and the mean velocity is Δx/T. With |a| ≤ A, Δx
/// differs by at most A·T²/4 from T times the mean of the velocities at both ends.
bool EntrySearch::is_out_of_reach(const Instant& from) const noexcept {
  constexpr double kSlack = 1 + 1e-9;
  const double duration = to_seconds(end_.state.time - from.time) * kSlack;
  for (std::size_t d = 0; d < from.position.size(); ++d) {
    const double way = end_.state.position[d] - from.position[d];
    const double v0 = from.velocity[d];
    const double v1 = end_.state.velocity[d];
    const double a_max = allowed_.acceleration[d];
    if (a_max > 0 && (std::abs(v1 - v0) > a_max * duration ||
                      std::abs(way - (v0 + v1) / 2 * duration) > a_max * duration * duration / 4)) {
      return true;
    }
    const double v_max = allowed_.velocity[d];
    if (v_max > 0 && std::abs(way) > v_max * duration) return true;
  }
  return false;
}

}  // namespace splinecast::core
