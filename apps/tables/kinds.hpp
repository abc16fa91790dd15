#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "apps/tables/waypoints.hpp"
#include "splinecast/dimension_kind.hpp"

namespace splinecast::apps {

/// Reads `I:K`: a dimension's index from 0, or name, and a kind. Nothing for any other text.
[[nodiscard]] std::optional<KindOption> parse_kind_option(const std::string& text);

/// The kind of each column: the requested one, else what the format defines, else `quaternion` for
/// four consecutive columns with such names (`qx qy qz qw`, `q_RS_w … q_RS_z`), else `linear`. The
/// position of w in a quaternion follows from the last letters of its columns' names; with other
/// names w is last. Throws InputError with the file and the option for an unknown dimension, two
/// kinds for one dimension, or a quaternion of fewer than four dimensions.
[[nodiscard]] std::vector<Dimension> resolve_kinds(const std::string& file,
                                                   const RowColumns& columns,
                                                   const std::vector<KindOption>& asked);

/// The first quaternion of a position that is not a rotation, with its columns, for a message;
/// nothing if all are rotations.
[[nodiscard]] std::optional<std::string> zero_quaternion(std::span<const double> position,
                                                         const std::vector<std::string>& names,
                                                         const DimensionKinds& kinds);

/// Changes each waypoint to the representative nearest to the previous one, as a solver does: see
/// DimensionKinds::continue_from. Values must be usable. Throws InputError with the line of a
/// quaternion of length 0.
void continue_waypoints(WaypointTable& table);

}  // namespace splinecast::apps
