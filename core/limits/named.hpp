#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "splinecast/limits.hpp"

/// Limits of joints by name, as robot descriptions give them, and how they become those of a
/// curve's dimensions.
namespace splinecast::core {

/// Whether a dimension's name is that of a joint: the same, or the same before a unit in brackets,
/// as in `q1 [rad]` or `q1 (rad)`.
[[nodiscard]] bool is_name_of(const std::string& joint, const std::string& dimension);

/// The limits of dimensions with these names; kinds of which no dimension has a limit are empty.
/// Throws std::invalid_argument, naming the dimension, if two joints have its name.
[[nodiscard]] MotionLimits matched(std::span<const NamedLimits> joints,
                                   std::span<const std::string> dimensions);

/// The joints that are the name of no dimension, in order.
[[nodiscard]] std::vector<std::string> unmatched(std::span<const NamedLimits> joints,
                                                 std::span<const std::string> dimensions);

/// The dimensions that have no limit of any kind; of a quaternion only its first.
[[nodiscard]] std::vector<std::size_t> without_limits(const MotionLimits& limits,
                                                      std::span<const Dimension> dimensions);

/// The limits of `base`, and instead of each kind that `by` has, its list. Bounds are one kind.
[[nodiscard]] MotionLimits overridden(const MotionLimits& base, const MotionLimits& by);

}  // namespace splinecast::core
