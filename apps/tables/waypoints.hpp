#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "apps/files/numbers.hpp"
#include "apps/process/exit_codes.hpp"
#include "splinecast/dimension_kind.hpp"
#include "splinecast/time.hpp"
#include "splinecast/waypoint.hpp"

namespace splinecast::apps {

/// A requested kind. The dimension is a name or an index from 0; of a quaternion, the first one.
struct KindOption {
  std::string dimension;
  Dimension kind{};
};

/// Options for reading a waypoint file.
struct TableOptions {
  std::vector<std::string> columns{};   ///< position columns, in this order; none: all numeric
  std::vector<KindOption> kinds{};      ///< of dimensions; others by the columns' names
  std::optional<TimeUnit> time_unit{};  ///< overrides the unit in the time column's name
  /// Called with the line of each row that cannot be read; the row is left out. Unset: the first
  /// such row throws.
  std::function<void(std::size_t line, const InputError&)> on_bad_row{};
};

/// The waypoints of a file.
class WaypointTable {
 public:
  std::string file;
  std::vector<std::string> names;  ///< of the position columns
  std::vector<Dimension> kinds;    ///< of these; none: all linear
  std::vector<Time> times;
  std::vector<std::size_t> lines;     ///< line of each waypoint in the file, from 1
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

  /// Keeps the rows for which `keeps(i)` returns true. Calls it once per row, in order; it may read
  /// row i. If it throws, the table is unusable.
  void keep_rows(const std::function<bool(std::size_t i)>& keeps);

  /// `file:line`, for messages.
  [[nodiscard]] std::string where(std::size_t i) const;
};

/// Reads a waypoint file: CSV with a header, which may be a `#` comment, or TUM text. Throws
/// InputError with file, line and column for a field that cannot be read. Accepts values that are
/// not finite and times that do not increase: the callers check these.
[[nodiscard]] WaypointTable read_waypoints(const std::string& path, const TableOptions& options);

/// Reads only the time column of such a file. Throws as read_waypoints() does.
[[nodiscard]] std::vector<Time> read_times(const std::string& path,
                                           std::optional<TimeUnit> time_unit);

/// Throws InputError with the line of the first waypoint that a spline cannot contain: not finite,
/// or not after the previous one.
void require_spline_input(const WaypointTable& table);

}  // namespace splinecast::apps
