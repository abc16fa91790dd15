#include "apps/recordings/advice.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>

#include "apps/process/exit_codes.hpp"

namespace splinecast::apps {
namespace {

Time rounded_up_to_ms(Time t) noexcept {
  constexpr Time kMillisecond = std::chrono::milliseconds(1);
  if (t > Time::max() - kMillisecond) return t;
  return std::chrono::ceil<std::chrono::milliseconds>(t);
}

/// Duration in s of the minimum-time motion that catches up with a target of constant velocity. At
/// its start the motion has a position lag of `distance` and is slower than the target by
/// `deficit`; it is never faster than the target by more than `most`.
double catch_up_time(double distance, double deficit, double acceleration, double most) {
  const double peak = std::sqrt(acceleration * distance + deficit * deficit / 2);
  if (peak <= most) return (2 * peak + deficit) / acceleration;
  const double covered = (most * most - deficit * deficit / 2) / acceleration;
  return (2 * most + deficit) / acceleration + (distance - covered) / most;
}

/// Time in s to return onto a path of constant velocity v, after the curve has followed a stop
/// segment of duration `stop` for `dry` s. nullopt if the velocity limit is not above v.
std::optional<double> return_time(double v, double dry, double stop, double max_velocity,
                                  double max_acceleration) {
  if (v == 0 || dry <= 0) return 0.0;
  const double u = std::min(dry / stop, 1.0);
  const double velocity = v * (1 - 3 * u * u + 2 * u * u * u);
  const double distance = v * dry - v * stop * (u - u * u * u + u * u * u * u / 2);
  const double reserve = max_velocity - v;
  if (reserve <= 0) return std::nullopt;
  return catch_up_time(distance, v - velocity, max_acceleration, reserve);
}

}  // namespace

Time depth_needed(Time interval, const SolvedHow& how) noexcept {
  return saturated_sum(how.settle_ahead,
                       saturated_product(interval, static_cast<std::int64_t>(how.settle) + 1));
}

Time depth_needed(Time interval, Time length, const SolvedHow& how) noexcept {
  return std::min(depth_needed(interval, how), saturated_sum(how.settle_ahead, length));
}

Time advised_lead(const Intervals& intervals, Time length, const SolvedHow& how) noexcept {
  const Time depth = depth_needed(intervals.median, length, how);
  return std::max(kLeastLead, rounded_up_to_ms(saturated_sum(depth, intervals.jitter)));
}

std::size_t advised_settle(const Intervals& intervals, Time settle_ahead) noexcept {
  constexpr std::size_t kFewest = 4;
  constexpr Time kLongestLead = std::chrono::seconds(1);
  std::size_t settle = SolvedHow{}.settle;
  const auto lead = [&] {
    return advised_lead(intervals, Time::max(), {.settle = settle, .settle_ahead = settle_ahead});
  };
  while (settle > kFewest && lead() > kLongestLead) --settle;
  return settle;
}

AdvisedLimits advised_limits(std::span<const DimensionMotion> motion) {
  constexpr double kLongestStop = 1;     // s
  constexpr double kStopPeak = 1.5;      // largest deceleration of a stop, in v/T
  constexpr Time kUnmoved{250'000'000};  // default of `solve`
  AdvisedLimits limits;
  double stop = 0;
  for (const DimensionMotion& d : motion) {
    limits.velocity.push_back(kLimitFactor * d.velocity);
    limits.acceleration.push_back(
        std::max(kLimitFactor * d.acceleration, kStopPeak * d.peak_velocity / kLongestStop));
    if (d.peak_velocity == 0) continue;
    stop = std::max(stop, kStopPeak * d.peak_velocity / limits.acceleration.back());
  }
  constexpr double kRounding = 1e-6;  // ms, rounding error of the quotients
  const auto milliseconds =
      std::chrono::milliseconds(std::llround(std::ceil(stop * 1e3 - kRounding)));
  limits.stop_length = stop == 0 ? kUnmoved : std::max(milliseconds, std::chrono::milliseconds(1));
  return limits;
}

SilenceEffect foresee(Time lead, Time silence, Time interval, Time settle_ahead,
                      std::span<const DimensionMotion> motion, const AdvisedLimits& limits) {
  const Time left = std::max(saturated_sum(saturated_sum(lead, -interval), -silence), -Time::max());
  SilenceEffect effect{.lead = lead,
                       .silence = silence,
                       .depth_left = std::max(left, Time::zero()),
                       .dry = std::max(saturated_sum(settle_ahead, -left), Time::zero())};
  effect.comes_to_rest = effect.dry >= limits.stop_length;
  for (std::size_t d = 0; d < motion.size(); ++d) {
    effect.return_time.push_back(return_time(motion[d].peak_velocity, to_seconds(effect.dry),
                                             to_seconds(limits.stop_length), limits.velocity[d],
                                             limits.acceleration[d]));
  }
  return effect;
}

Advice advise(const WaypointTable& table, Time settle_ahead, std::optional<std::size_t> settle,
              bool continues) {
  constexpr std::array<Time, 2> kSilences{std::chrono::milliseconds(100),
                                          std::chrono::milliseconds(300)};
  if (table.size() < 3) {
    throw InputError(
        fmt::format("{}: {} rows in order: advice needs at least 3", table.file, table.size()));
  }
  const Intervals intervals = measure_intervals(table.times);
  const SolvedHow how{.settle = settle.value_or(advised_settle(intervals, settle_ahead)),
                      .settle_ahead = settle_ahead};
  const Time length = continues ? Time::max() : table.times.back() - table.times.front();
  Advice advice{.intervals = intervals,
                .motion = measure_motion(table, intervals),
                .how = how,
                .depth_needed = depth_needed(intervals.median, how),
                .lead = advised_lead(intervals, length, how)};
  advice.limits = advised_limits(advice.motion);
  for (const Time lead : {advice.lead, kShortLead}) {
    for (const Time silence : kSilences) {
      advice.silences.push_back(
          foresee(lead, silence, intervals.median, settle_ahead, advice.motion, advice.limits));
    }
  }
  return advice;
}

}  // namespace splinecast::apps
