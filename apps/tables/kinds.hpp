#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/tables/waypoints.hpp"
#include "splinecast/dimension_kind.hpp"

namespace splinecast::apps {

/// Reads `I:K`: a dimension's index from 0, or name, and a kind. Nothing for any other text.
[[nodiscard]] std::optional<KindOption> parse_kind_option(const std::string& text);

/// The position columns of a file: their names and, if a comment gives them, other names.
struct ColumnNames {
  const std::vector<std::string>& names;
  const std::vector<std::string>& aliases;
};

/// The kind of each column: what is asked for, else `quaternion` for four columns in a row that are
/// named so (`qx qy qz qw`, `q_RS_w … q_RS_z`), else `linear`. Where a quaternion has w follows
/// from the last letters of its columns' names; if they say nothing, last. Throws InputError,
/// naming the file and the option, for a dimension that there is not, two kinds for one, or too few
/// dimensions.
[[nodiscard]] std::vector<Dimension> resolve_kinds(const std::string& file,
                                                   const ColumnNames& columns,
                                                   const std::vector<KindOption>& asked);

/// What is wrong with the quaternions of row i, naming its columns; nothing if a rotation can be
/// made of each.
[[nodiscard]] std::optional<std::string> zero_quaternion(const WaypointTable& table,
                                                         const DimensionKinds& kinds,
                                                         std::size_t i);

/// Moves each waypoint to the representative nearest to the one before, as a solver does with what
/// it is sent: see DimensionKinds::continue_from. Values must be usable. Throws InputError
/// naming the line of a quaternion of length 0.
void continue_waypoints(WaypointTable& table);

}  // namespace splinecast::apps
