#include "core/forms/entry.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/forms/chord.hpp"
#include "splinecast/state.hpp"

namespace splinecast::core {

double seconds_from_rest(double distance, double velocity, double acceleration,
                         double jerk) noexcept {
  // Peaks over the distance 1 in 1 s.
  constexpr double kVelocity = 15.0 / 8;
  constexpr double kAcceleration = 10 / std::numbers::sqrt3;
  constexpr double kJerk = 60;
  double seconds = 0;
  if (velocity > 0) seconds = kVelocity * distance / velocity;
  if (acceleration > 0) {
    seconds = std::max(seconds, std::sqrt(kAcceleration * distance / acceleration));
  }
  if (jerk > 0) seconds = std::max(seconds, std::cbrt(kJerk * distance / jerk));
  return seconds;
}

void build_entry(const Instant& from, const Instant& to, Segment& out) noexcept {
  const std::size_t dimensions = from.position.size();
  const double h = to_seconds(to.time - from.time);
  std::array<double, kMaxDimensions> chord{};
  write_chord(from.position, to.position, h, std::span(chord).first(dimensions));
  build_segment({.left = from.time,
                 .right = to.time,
                 .h = h,
                 .x0 = from.position,
                 .chord = std::span(chord).first(dimensions),
                 .v0 = from.velocity,
                 .v1 = to.velocity,
                 .a0 = from.acceleration,
                 .a1 = to.acceleration},
                out);
  out.kind = SegmentKind::entry;
}

}  // namespace splinecast::core
