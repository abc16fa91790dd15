#pragma once

#include <cstdint>
#include <functional>
#include <nlohmann/json.hpp>

#include "apps/process/child.hpp"
#include "apps/process/signals.hpp"
#include "bench/harness/trips.hpp"
#include "splinecast/time.hpp"

/// What all round trips share: payload, cache lines and measurement.
namespace splinecast::bench {

inline constexpr std::size_t kTripDimensions = 7;
inline constexpr Time kTripInterval{10'000'000};

/// Lines of SharedLines: one per direction, and one that signals that the far side is ready.
enum Line : std::size_t { kThere, kBack, kFarIsReady };

/// Time of the i-th waypoint, i ≥ 1.
[[nodiscard]] inline Time time_of(std::uint64_t i) {
  return kTripInterval * static_cast<std::int64_t>(i);
}

/// Measures trips 2, 3, …, without the first thousand, and returns a summary for `report`.
/// `trip(i)` makes one round trip; if it returns false, throws std::runtime_error.
[[nodiscard]] nlohmann::json measure(const std::function<bool(std::uint64_t)>& trip);

}  // namespace splinecast::bench
