#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "apps/tables/options.hpp"
#include "apps/tables/rows.hpp"
#include "splinecast/dimension_kind.hpp"
#include "splinecast/time.hpp"
#include "splinecast/waypoint.hpp"

namespace splinecast::apps {

/// The waypoints of a file.
class WaypointTable {
 public:
  std::string file;
  std::vector<std::string> names;  ///< of the position columns
  std::vector<Dimension> kinds;    ///< of these; none: all linear
  std::vector<Time> times;
  std::vector<std::size_t> lines;     ///< number of each row in the file: see Row::number
  std::vector<double> positions;      ///< [waypoint][dimension]
  std::vector<double> velocities;     ///< [waypoint][dimension], or empty if the file has none
  std::vector<double> accelerations;  ///< [waypoint][dimension], or empty if the file has none

  [[nodiscard]] std::size_t dimensions() const noexcept { return names.size(); }
  [[nodiscard]] std::size_t size() const noexcept { return times.size(); }
  [[nodiscard]] Waypoint waypoint(std::size_t i) const noexcept;

  /// A view of all waypoints.
  [[nodiscard]] Waypoints waypoints() const noexcept {
    return {.dimensions = dimensions(),
            .times = times,
            .positions = positions,
            .velocities = velocities,
            .accelerations = accelerations};
  }

  /// The place of row i, for messages: as RowReader::where, or `file:line`.
  [[nodiscard]] std::string where(std::size_t i) const;
  /// What a row's number counts, as RowReader::row_name.
  [[nodiscard]] std::string_view row_name() const noexcept;
  std::shared_ptr<const RowReader> source{};  ///< for these; null: a text with this name
};

/// Reads a file of any format whole, see open_rows(). A derivative that only some of the rows have
/// is left out, with a message on standard error. Throws InputError with the row, the column and
/// the value if a field cannot be read. Accepts values that are not finite and times that do not
/// increase: the callers check these.
[[nodiscard]] WaypointTable read_waypoints(const std::string& path, const TableOptions& options);

/// Reads only the times of such a file. Throws as read_waypoints() does.
[[nodiscard]] std::vector<Time> read_times(const std::string& path, TableOptions options);

/// Throws InputError with the place of the first waypoint that a spline cannot contain: not finite,
/// or not after the previous one.
void require_spline_input(const WaypointTable& table);

}  // namespace splinecast::apps
