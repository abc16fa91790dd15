#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "splinecast/state.hpp"
#include "splinecast/time.hpp"

namespace [[gnu::visibility("default")]] splinecast {

/// The largest magnitude of a position, velocity or acceleration. Far above any real value, and
/// small enough that no formula overflows.
inline constexpr double kLargestValue = 1e100;

/// Whether a value is valid: not NaN and within ±kLargestValue.
[[nodiscard]] constexpr bool is_usable(double value) noexcept {
  return value >= -kLargestValue && value <= kLargestValue;  // false for NaN
}

/// The earliest and latest times: the difference of any two fits into 64 bits.
inline constexpr Time kLatestTime{(std::int64_t{1} << 62U) - 1};
static_assert(kLatestTime - -kLatestTime > Time::zero());
[[nodiscard]] constexpr bool is_time_in_range(Time time) noexcept {
  return time >= -kLatestTime && time <= kLatestTime;
}

/// The input from a producer: a time, a position and, optionally, velocity and acceleration. Views
/// hold one value per dimension; an empty one means "not given". Does not own its values, which may
/// be a std::vector, std::array, std::span or an Eigen vector: `{.time = t, .position = x}`.
struct Waypoint {
  Time time{};
  VectorView position{};
  VectorView velocity{};
  VectorView acceleration{};
};

/// A state at an instant. Views hold one value per dimension; does not own them.
struct Instant {
  Time time{};
  VectorView position{};
  VectorView velocity{};
  VectorView acceleration{};
};

/// Waypoints of a whole recording: values are [waypoint][dimension]; `velocities` and
/// `accelerations` are empty if not given. A view: it owns nothing.
struct Waypoints {
  std::size_t dimensions = 0;
  std::span<const Time> times{};
  std::span<const double> positions{};
  std::span<const double> velocities{};
  std::span<const double> accelerations{};

  [[nodiscard]] std::size_t size() const noexcept { return times.size(); }
  [[nodiscard]] Waypoint operator[](std::size_t i) const noexcept {
    const auto row = [&](std::span<const double> values) {
      return values.empty() ? values : values.subspan(i * dimensions, dimensions);
    };
    return {.time = times[i],
            .position = row(positions),
            .velocity = row(velocities),
            .acceleration = row(accelerations)};
  }
};

}  // namespace splinecast
