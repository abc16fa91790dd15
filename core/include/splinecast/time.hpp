#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>

namespace [[gnu::visibility("default")]] splinecast {

/// A time of a stream or a difference of times: integer nanoseconds, so that epoch stamps are
/// exact.
using Time = std::chrono::nanoseconds;

/// Converts a *difference* of times to seconds, rounded once. Times affect the values of a curve
/// only through this function: differences are taken in integers first, so that adding the same
/// offset to every time of a stream changes no bit of its curve.
[[nodiscard]] constexpr double to_seconds(Time difference) noexcept {
  return static_cast<double>(difference.count()) / 1e9;
}

/// The smallest time ≥ `seconds`, which must not be NaN; clamped to ±4·10⁹ s.
[[nodiscard]] inline Time from_seconds(double seconds) noexcept {
  constexpr double kMost = 4e9;
  return Time(static_cast<std::int64_t>(std::ceil(std::clamp(seconds, -kMost, kMost) * 1e9)));
}

/// a + b, or the largest time in that direction if the sum overflows.
[[nodiscard]] constexpr Time saturated_sum(Time a, Time b) noexcept {
  std::int64_t sum = 0;
  if (!__builtin_add_overflow(a.count(), b.count(), &sum)) return Time(sum);
  return b < Time::zero() ? Time::min() : Time::max();
}

/// factor · a, with the same saturation; the factor is not negative.
[[nodiscard]] constexpr Time saturated_product(Time a, std::int64_t factor) noexcept {
  std::int64_t product = 0;
  if (!__builtin_mul_overflow(a.count(), factor, &product)) return Time(product);
  return a < Time::zero() ? Time::min() : Time::max();
}

}  // namespace splinecast
