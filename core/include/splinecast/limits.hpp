#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "splinecast/dimension_kind.hpp"
#include "splinecast/time.hpp"

/// Limits of motion, in the units of the dimensions. Unless a function says otherwise, it is O(D),
/// allocates nothing and throws nothing.
namespace [[gnu::visibility("default")]] splinecast {

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

/// A kind of limit.
enum class LimitKind : std::uint8_t { velocity = 0, acceleration = 1, jerk = 2, position = 3 };
inline constexpr std::size_t kLimitKinds = 4;
[[nodiscard]] std::string_view to_string(LimitKind kind) noexcept;

/// Where a segment, or a state, comes nearest to a limit, or is farthest beyond it.
struct Excess {
  /// Value over limit. Of a position: its distance from the middle of its bounds over half their
  /// distance; where one bound only is finite, 1 plus what is beyond it over its size, or over 1 if
  /// that is larger. Negative: there is no limit; infinite: the value is no number.
  double ratio = -1;
  LimitKind kind = LimitKind::velocity;
  std::size_t dimension = 0;  ///< of a quaternion its first
  double value = 0;           ///< with its sign; of a quaternion the bound of its magnitude
  double limit = 0;           ///< the limit, what is allowed instead, or the bound of a position
  double u = 0;               ///< seconds after the left end of the segment; 0 of a state
};

/// The limits of one joint, as in MotionLimits.
struct NamedLimits {
  std::string name;
  double velocity = 0;
  double acceleration = 0;
  double jerk = 0;
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
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

}  // namespace splinecast
