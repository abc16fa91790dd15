#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "splinecast/dimension_kind.hpp"
#include "splinecast/limits.hpp"
#include "splinecast/time.hpp"

namespace splinecast::core {

/// How far positions are from one another, and how long the way takes.
class WayBetween {
 public:
  explicit WayBetween(const DimensionKinds& kinds, std::size_t dimensions)
      : kinds_(kinds), to_(dimensions), distances_(dimensions) {}

  /// Measures the way: in a periodic dimension the shorter one, of a quaternion
  /// its angle in each of its dimensions. The positions have valid quaternions.
  /// O(D).
  void measure(std::span<const double> from, std::span<const double> to) noexcept;

  [[nodiscard]] std::span<const double> distances() const noexcept { return distances_; }

  /// Duration in seconds of a motion from rest to rest over the distance of
  /// dimension d within its limits; nothing if it has none.
  [[nodiscard]] std::optional<double> seconds(std::size_t d,
                                              const MotionLimits& limits) const noexcept;

  /// Duration of an entry over all of the way: 1 s in a dimension without
  /// limits. O(D).
  [[nodiscard]] Time entry_time(const MotionLimits& limits) const noexcept;

 private:
  DimensionKinds kinds_;
  std::vector<double> to_;  ///< the representative of the position nearest to `from`
  std::vector<double> distances_;
};

}  // namespace splinecast::core
