#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/polynomial/segment.hpp"
#include "splinecast/dimension_kind.hpp"
#include "splinecast/time.hpp"

/// Limits of motion. Stop tails and splices keep those of acceleration; curves can be compared with
/// all of them (limit_check.hpp). 0 means no limit; a span holds one value per dimension, and an
/// empty one means no limits. Unless a function says otherwise, it is O(D), allocates nothing and
/// throws nothing.
namespace splinecast::core {

/// Limits of velocity, acceleration and jerk, and bounds of the position, in the units of the
/// dimensions. Each list has one value per dimension, or none: no limit of that kind.
struct MotionLimits {
  std::vector<double> velocity{};  ///< of the absolute value, as the next two; 0: none
  std::vector<double> acceleration{};
  std::vector<double> jerk{};
  std::vector<double> lower{};  ///< bounds of the position; −∞ and +∞: none
  std::vector<double> upper{};

  /// Whether there is no limit of any kind: every value says "none".
  [[nodiscard]] bool empty() const noexcept;

  friend bool operator==(const MotionLimits&, const MotionLimits&) = default;
};

/// What a solver does about a waypoint with which the curve passes a limit.
enum class Beyond : std::uint8_t {
  report = 0,  ///< take it, count it and note where
  refuse = 1,  ///< refuse it
};

/// Throws std::invalid_argument, naming the limit and its value, unless every limit is a positive
/// number up to kLargestValue or says "none", and every lower bound lies below its upper bound.
void require_limits(const MotionLimits& limits);

/// The same; in addition every list must be empty or have one value per dimension.
void require_limits(const MotionLimits& limits, std::size_t dimensions);

/// The same; in addition a wrapping dimension and a quaternion must have no bounds, and a
/// quaternion's second to fourth dimension no limits but those of the first.
void require_limits(const MotionLimits& limits, std::span<const Dimension> dimensions);

/// Limits of which each list has one value per dimension or none: a list of one value holds for
/// all dimensions. Throws std::invalid_argument for other sizes. Allocates.
[[nodiscard]] MotionLimits spread(const MotionLimits& limits, std::size_t dimensions);

}  // namespace splinecast::core
