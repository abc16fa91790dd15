#include "core/solvers/knot_ring.hpp"

#include <algorithm>
#include <array>
#include <bit>

#include "core/polynomial/cubic.hpp"
#include "core/simd/clones.hpp"
#include "core/simd/lanes.hpp"
#include "core/solvers/smoothing_system.hpp"
#include "splinecast/state.hpp"

namespace splinecast::core {
namespace {

constexpr std::array<double, kMaxDimensions> kZeros{};

std::size_t values_kept(const Method& method) noexcept {
  if (method.smooths()) return KnotRing::kPositionChord + 1;
  return method.needs_acceleration() ? KnotRing::kAcceleration + 1 : KnotRing::kVelocity + 1;
}

/// Rounds up to whole vector registers: see for_padded_lanes.
std::size_t padded(std::size_t dimensions) noexcept {
  return dimensions <= 2 ? 2 : (dimensions + 3) / 4 * 4;
}

}  // namespace

KnotRing::KnotRing(std::size_t dimensions, std::size_t capacity, const Method& method,
                   bool halts_at_start)
    : dimensions_(dimensions),
      smooths_(method.smooths()),
      has_accelerations_(method.needs_acceleration()),
      halts_at_start_(halts_at_start),
      mask_(std::bit_ceil(capacity) - 1),
      stride_(padded(dimensions)),
      kinds_(values_kept(method)),
      rows_(mask_ + 1),
      gammas_(mask_ + 1),
      values_((mask_ + 1) * kinds_ * stride_),
      newer_knots_(mask_ + 1),
      smoothing_(smooths_ ? mask_ + 1 : 0) {}

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
  }
  return at;
}

void KnotRing::measure_chord(std::size_t i) noexcept {
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
  push(time);
  std::ranges::copy(waypoint, values(newest(), kWaypoint).begin());
  if (newest() > 0) measure_chord(newest() - 1);
}

void KnotRing::restore(std::size_t first, std::span<const Knot> knots) noexcept {
  for (std::size_t k = 0; k < knots.size(); ++k) {
    const Knot& knot = knots[k];
    const std::size_t i = first + k;
    place(i, knot.time);
    gamma(i) = knot.prefix.gamma;
    newer_knots_[i & mask_] = knot.newer_knots;
    std::ranges::copy(knot.waypoint, values(i, kWaypoint).begin());
    std::ranges::copy(knot.g, values(i, kG).begin());
    std::ranges::copy(knot.velocity, values(i, kVelocity).begin());
    if (has_accelerations_) std::ranges::copy(knot.acceleration, values(i, kAcceleration).begin());
    if (smooths_) {
      smoothing(i) = knot.prefix.smoothing;
      std::ranges::copy(knot.position, values(i, kPosition).begin());
      std::ranges::copy(knot.residual, values(i, kResidual).begin());
    }
    if (k == 0) continue;
    row(i - 1).h = to_seconds(knot.time - row(i - 1).time);
    measure_chord(i - 1);
    if (smooths_) measure_smoothed(i - 1);
  }
  size_ = first + knots.size();
  first_solved_ = size_;
}

/// Sets the acceleration at a full stop to 0, at either end, regardless of the knot velocities.
void KnotRing::halt(std::size_t i, Interval& interval) const noexcept {
  const auto zeros = std::span(kZeros).first(dimensions_);
  if (halts_at_start_ && i == 0) interval.a0 = zeros;
  if (halts_at_end_ && i + 1 == newest()) interval.a1 = zeros;
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

void write_acceleration_step(const KnotRing& knots, std::size_t i, const Interval& interval,
                             bool held_before, std::span<double> step) noexcept {
  if (i == 0 && !held_before) {
    std::ranges::fill(step, 0.0);
    return;
  }
  if (i == 0) {
    write_left_acceleration(interval, step);
  } else {
    write_acceleration_jump(knots.interval(i - 1), interval, step);
  }
}

}  // namespace splinecast::core
