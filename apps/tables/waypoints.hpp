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

/// A kind that is asked for: of a dimension by name, or by index from 0; of a quaternion, the
/// first.
struct KindOption {
  std::string dimension;
  Dimension kind{};
};

/// How a waypoint file is to be read.
struct TableOptions {
  std::vector<std::string> columns{};   ///< position columns, in this order; none: all numeric
  std::vector<KindOption> kinds{};      ///< of dimensions; else by the columns' names
  std::optional<TimeUnit> time_unit{};  ///< overrides what the time column's name says
  /// Called with the line of each row that cannot be read, which is then left out; unset: the first
  /// one throws.
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
  std::vector<double> velocities;     ///< likewise, or empty if the file gives none
  std::vector<double> accelerations;  ///< likewise

  [[nodiscard]] std::size_t dimensions() const noexcept { return names.size(); }
  [[nodiscard]] std::size_t size() const noexcept { return times.size(); }
  [[nodiscard]] Waypoint waypoint(std::size_t i) const noexcept;

  /// A view of all of them.
  [[nodiscard]] Waypoints waypoints() const noexcept {
    return {.dimensions = dimensions(),
            .times = times,
            .positions = positions,
            .velocities = velocities,
            .accelerations = accelerations};
  }

  /// Keeps the rows for which `keeps(i)` says so; it is asked about each in their order, and may
  /// read row i then. If it throws, the table is of no further use.
  void keep_rows(const std::function<bool(std::size_t i)>& keeps);

  /// `file:line`, for messages.
  [[nodiscard]] std::string where(std::size_t i) const;
};

/// Reads a waypoint file: CSV with a header, also one behind `#`, or TUM text. Throws InputError
/// naming file, line and column for whatever cannot be read. What is read need not be finite or
/// increasing in time: that is judged where it is used.
[[nodiscard]] WaypointTable read_waypoints(const std::string& path, const TableOptions& options);

/// Reads only the time column of such a file. Throws likewise.
[[nodiscard]] std::vector<Time> read_times(const std::string& path,
                                           std::optional<TimeUnit> time_unit);

/// Throws InputError naming the line of the first waypoint that no spline can take: not finite, or
/// not after the one before.
void require_spline_input(const WaypointTable& table);

}  // namespace splinecast::apps
