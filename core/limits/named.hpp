#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "splinecast/limits.hpp"

/// Limits of joints by name, as in robot descriptions, and their conversion to limits of a curve's
/// dimensions.
namespace splinecast::core {

/// Whether a dimension has the name of a joint: the same name, or the same before a unit in
/// brackets, as in `q1 [rad]` or `q1 (rad)`.
[[nodiscard]] bool is_name_of(const std::string& joint, const std::string& dimension);

/// The limits of the dimensions with these names. The list of a kind is empty if no dimension has a
/// limit of that kind. Throws std::invalid_argument, naming the dimension, if two joints have its
/// name.
[[nodiscard]] MotionLimits matched(std::span<const NamedLimits> joints,
                                   std::span<const std::string> dimensions);

/// The names of the joints without a dimension, in order.
[[nodiscard]] std::vector<std::string> unmatched(std::span<const NamedLimits> joints,
                                                 std::span<const std::string> dimensions);

/// The dimensions that have no limit of any kind; for a quaternion only its first dimension.
[[nodiscard]] std::vector<std::size_t> without_limits(const MotionLimits& limits,
                                                      std::span<const Dimension> dimensions);

/// The limits of `base`; a list that `by` has replaces that of `base`. Lower and upper bounds are
/// replaced together.
[[nodiscard]] MotionLimits overridden(const MotionLimits& base, const MotionLimits& by);

}  // namespace splinecast::core
