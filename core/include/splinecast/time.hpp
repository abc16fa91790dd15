#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>

namespace [[gnu::visibility("default")]] splinecast {

/// A stream's time and its differences: integer nanoseconds, so that epoch stamps lose nothing.
using Time = std::chrono::nanoseconds;

/// Converts a *difference* of times to seconds, rounded once. The only way by which times enter the
/// values of a curve: differences are taken in integers first, so that adding the same offset to
/// every time of a stream changes no bit of its curve.
[[nodiscard]] constexpr double to_seconds(Time difference) noexcept {
  return static_cast<double>(difference.count()) / 1e9;
}

/// The least time of at least so many seconds, which must be a number; at most 4·10⁹ s.
[[nodiscard]] inline Time from_seconds(double seconds) noexcept {
  constexpr double kMost = 4e9;
  return Time(static_cast<std::int64_t>(std::ceil(std::clamp(seconds, -kMost, kMost) * 1e9)));
}

/// a + b, or the last time there is in that direction.
[[nodiscard]] constexpr Time saturated_sum(Time a, Time b) noexcept {
  std::int64_t sum = 0;
  if (!__builtin_add_overflow(a.count(), b.count(), &sum)) return Time(sum);
  return b < Time::zero() ? Time::min() : Time::max();
}

/// factor · a, likewise; the factor is not negative.
[[nodiscard]] constexpr Time saturated_product(Time a, std::int64_t factor) noexcept {
  std::int64_t product = 0;
  if (!__builtin_mul_overflow(a.count(), factor, &product)) return Time(product);
  return a < Time::zero() ? Time::min() : Time::max();
}

}  // namespace splinecast
