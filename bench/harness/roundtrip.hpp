#pragma once

#include <cstdint>
#include <functional>
#include <nlohmann/json.hpp>

#include "apps/process/child.hpp"
#include "apps/process/signals.hpp"
#include "bench/harness/trips.hpp"
#include "splinecast/time.hpp"

/// What all round trips share: payload, count, and who sits on which core.
namespace splinecast::bench {

inline constexpr std::size_t kTripDimensions = 7;
inline constexpr Time kTripInterval{10'000'000};

/// Lines of SharedLines: one each way, and one that says that the far side is there.
enum Line : std::size_t { kThere, kBack, kFarIsReady };

/// Time of the i-th waypoint, i ≥ 1.
[[nodiscard]] inline Time time_of(std::uint64_t i) {
  return kTripInterval * static_cast<std::int64_t>(i);
}

/// Measures trips 2, 3, …, the first thousand aside, and returns what `report` takes. `trip(i)`
/// goes there and back; it returns false to give up, and then this throws.
[[nodiscard]] nlohmann::json measure(const std::function<bool(std::uint64_t)>& trip);

}  // namespace splinecast::bench
