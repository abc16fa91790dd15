#pragma once

#include <chrono>
#include <cstdint>

namespace splinecast::core {

/// A stream's time and its differences: integer nanoseconds, so that epoch stamps lose nothing.
using Time = std::chrono::nanoseconds;

/// Converts a *difference* of times to seconds, rounded once. The only place where time becomes
/// floating point: differences are taken in integers first, so that adding the same offset to
/// every time of a stream changes no bit of its curve.
[[nodiscard]] constexpr double to_seconds(Time difference) noexcept {
  return static_cast<double>(difference.count()) / 1e9;
}

}  // namespace splinecast::core
