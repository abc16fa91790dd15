#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "splinecast/dimension_kind.hpp"
#include "splinecast/time.hpp"

/// Motion limits, in the units of the dimensions. Functions are O(D) and do not allocate or throw
/// unless documented.
namespace [[gnu::visibility("default")]] splinecast {

/// Limits of velocity, acceleration and jerk, and bounds of the position, in the units of the
/// dimensions. A list has one value per dimension; an empty list means no limit of that kind.
struct MotionLimits {
  std::vector<double> velocity{};  ///< limits of absolute values, as the next two; 0: none
  std::vector<double> acceleration{};
  std::vector<double> jerk{};
  std::vector<double> lower{};  ///< bounds of the position; −∞ and +∞: none
  std::vector<double> upper{};

  /// Whether no dimension has a limit of any kind.
  [[nodiscard]] bool empty() const noexcept;

  friend bool operator==(const MotionLimits&, const MotionLimits&) = default;
};

/// A kind of limit.
enum class LimitKind : std::uint8_t { velocity = 0, acceleration = 1, jerk = 2, position = 3 };
inline constexpr std::size_t kLimitKinds = 4;
[[nodiscard]] std::string_view to_string(LimitKind kind) noexcept;

/// The point of a segment, or a state, that is nearest to a limit or exceeds one the most.
struct Excess {
  /// Value / limit. For a position: its distance from the middle of the bounds / half the distance
  /// between them; with only one finite bound b, 1 + the amount by which b is exceeded /
  /// max(1,|b|). Negative if there is no limit, infinite if the value is NaN.
  double ratio = -1;
  LimitKind kind = LimitKind::velocity;
  std::size_t dimension = 0;  ///< for a quaternion its first
  double value = 0;           ///< signed; for a quaternion, an upper bound of the magnitude
  double limit = 0;           ///< the limit, the allowance that replaces it, or a position bound
  double u = 0;               ///< seconds after the left end of the segment; 0 for a state
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

/// What a solver does with a waypoint that makes the curve exceed a limit. 3 is reserved.
enum class Beyond : std::uint8_t {
  report = 0,  ///< accept it, count it and record where
  refuse = 1,  ///< refuse it
  enter = 2,   ///< accept it, and leave the spline for an entry that keeps the limits; live streams
};
inline constexpr std::uint8_t kBeyonds = 3;
[[nodiscard]] std::string_view to_string(Beyond beyond) noexcept;
/// `report`, `refuse` or `enter`; nothing for any other text.
[[nodiscard]] std::optional<Beyond> parse_beyond(std::string_view text) noexcept;

/// Throws std::invalid_argument, naming the limit and its value, unless every limit is 0 (none) or
/// positive and at most kLargestValue, and every lower bound is below its upper bound.
void require_limits(const MotionLimits& limits);

/// The same; in addition every list must be empty or have one value per dimension.
void require_limits(const MotionLimits& limits, std::size_t dimensions);

/// The same; in addition a periodic dimension and a quaternion must have no bounds, and the second
/// to fourth dimension of a quaternion must have no limit or that of the first.
void require_limits(const MotionLimits& limits, std::span<const Dimension> dimensions);

/// Expands lists of one value to all dimensions. The lists of the result are empty or have one
/// value per dimension. Throws std::invalid_argument for other sizes. Allocates.
[[nodiscard]] MotionLimits spread(const MotionLimits& limits, std::size_t dimensions);

}  // namespace splinecast
