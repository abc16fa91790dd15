#include "splinecast/core/knot_ring.hpp"

#include <algorithm>
#include <array>
#include <bit>

#include "smoothing_system.hpp"
#include "splinecast/core/state.hpp"

namespace splinecast::core {
namespace {

constexpr std::array<double, kMaxDimensions> kZeros{};

std::size_t values_kept(const Method& method) noexcept {
  if (method.family == Family::smoothing) return KnotRing::kPositionChord + 1;
  return method.needs_acceleration() ? KnotRing::kAcceleration + 1 : KnotRing::kVelocity + 1;
}

}  // namespace

void write_chord(std::span<const double> from, std::span<const double> to, double h,
                 std::span<double> slope) noexcept {
  const double* __restrict const x0 = from.data();
  const double* __restrict const x1 = to.data();
  double* __restrict const m = slope.data();
  for (std::size_t d = 0; d < slope.size(); ++d) m[d] = (x1[d] - x0[d]) / h;
}

KnotRing::KnotRing(std::size_t dimensions, std::size_t capacity, const Method& method,
                   bool halts_at_start)
    : dimensions_(dimensions),
      smooths_(method.family == Family::smoothing),
      has_accelerations_(method.needs_acceleration()),
      halts_at_start_(halts_at_start),
      mask_(std::bit_ceil(capacity) - 1),
      values_per_knot_(values_kept(method)),
      rows_(mask_ + 1),
      values_((mask_ + 1) * values_per_knot_ * dimensions) {}

Neighbours KnotRing::neighbours(std::size_t i) const noexcept {
  return {.h_before = row(i - 1).h,
          .h_after = row(i).h,
          .chord_before = chord(i - 1),
          .chord_after = chord(i)};
}

EndIntervals KnotRing::start_intervals() const noexcept {
  EndIntervals at{.h = row(0).h, .chord = chord(0)};
  if (size_ > 2) {
    at.h_next = row(1).h;
    at.chord_next = chord(1);
  }
  return at;
}

EndIntervals KnotRing::end_intervals() const noexcept {
  const std::size_t n = newest();
  EndIntervals at{.h = row(n - 1).h, .chord = chord(n - 1)};
  if (n > 1) {
    at.h_next = row(n - 2).h;
    at.chord_next = chord(n - 2);
  } else {
    at.h_next = before_.h;
    at.chord_next = before_.chord;
  }
  return at;
}

void KnotRing::place(std::size_t i, Time time, std::span<const double> waypoint) noexcept {
  row(i) = {.time = time, .h = 0, .prefix = {}, .newer_knots = 0};
  std::ranges::copy(waypoint, values(i, kWaypoint).begin());
}

/// Length and chord slope of interval i.
void KnotRing::measure(std::size_t i) noexcept {
  row(i).h = to_seconds(row(i + 1).time - row(i).time);
  write_chord(values(i, kWaypoint), values(i + 1, kWaypoint), row(i).h, values(i, kChord));
}

void KnotRing::measure_smoothed(std::size_t i) noexcept {
  const auto slope = values(i, kPositionChord);
  for (std::size_t d = 0; d < dimensions_; ++d) {
    slope[d] = smoothed_chord(values(i, kChord)[d], row(i).h, values(i, kResidual)[d],
                              values(i + 1, kResidual)[d]);
  }
}

void KnotRing::push(Time time, std::span<const double> waypoint) noexcept {
  const std::size_t i = size_++;
  place(i, time, waypoint);
  if (i > 0) measure(i - 1);
}

void KnotRing::restore(std::size_t first, std::span<const Knot> knots) noexcept {
  for (std::size_t k = 0; k < knots.size(); ++k) {
    const Knot& knot = knots[k];
    const std::size_t i = first + k;
    place(i, knot.time, knot.waypoint);
    row(i).prefix = knot.prefix;
    row(i).newer_knots = knot.newer_knots;
    std::ranges::copy(knot.g, values(i, kG).begin());
    std::ranges::copy(knot.velocity, values(i, kVelocity).begin());
    if (has_accelerations_) std::ranges::copy(knot.acceleration, values(i, kAcceleration).begin());
    if (smooths_) {
      std::ranges::copy(knot.position, values(i, kPosition).begin());
      std::ranges::copy(knot.residual, values(i, kResidual).begin());
    }
    if (k == 0) continue;
    measure(i - 1);
    if (smooths_) measure_smoothed(i - 1);
  }
  size_ = first + knots.size();
}

Knot KnotRing::knot(std::size_t i) const noexcept {
  Knot knot{.time = row(i).time,
            .prefix = row(i).prefix,
            .newer_knots = row(i).newer_knots,
            .waypoint = values(i, kWaypoint),
            .g = values(i, kG),
            .position = position(i),
            .velocity = values(i, kVelocity),
            .acceleration = {},
            .residual = {}};
  if (has_accelerations_) knot.acceleration = values(i, kAcceleration);
  if (smooths_) knot.residual = values(i, kResidual);
  return knot;
}

Interval KnotRing::interval(std::size_t i) const noexcept {
  Interval interval{.left = row(i).time,
                    .right = row(i + 1).time,
                    .h = row(i).h,
                    .x0 = position(i),
                    .chord = chord(i),
                    .v0 = values(i, kVelocity),
                    .v1 = values(i + 1, kVelocity),
                    .a0 = {},
                    .a1 = {}};
  if (has_accelerations_) {
    interval.a0 = values(i, kAcceleration);
    interval.a1 = values(i + 1, kAcceleration);
  }
  const auto zeros = std::span(kZeros).first(dimensions_);
  if (halts_at_start_ && i == 0) interval.a0 = zeros;
  if (halts_at_end_ && i + 1 == newest()) interval.a1 = zeros;
  return interval;
}

void KnotRing::write_final_acceleration(std::span<double> acceleration) const noexcept {
  if (newest() > 0) {
    write_right_acceleration(interval(newest() - 1), acceleration);
  } else if (has_accelerations_) {
    std::ranges::copy(values(0, kAcceleration), acceleration.begin());
  } else {
    std::ranges::fill(acceleration, 0.0);
  }
}

void write_acceleration_step(const KnotRing& knots, std::size_t i, bool held_before,
                             std::span<double> step) noexcept {
  if (i == 0 && !held_before) {
    std::ranges::fill(step, 0.0);
    return;
  }
  write_left_acceleration(knots.interval(i), step);
  if (i == 0) return;
  std::array<double, kMaxDimensions> before{};
  write_right_acceleration(knots.interval(i - 1), std::span(before).first(step.size()));
  for (std::size_t d = 0; d < step.size(); ++d) step[d] -= before[d];
}

}  // namespace splinecast::core
