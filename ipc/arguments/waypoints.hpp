#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "ipc/arguments/arrays.hpp"
#include "splinecast/state.hpp"
#include "splinecast/waypoint.hpp"

namespace splinecast::ipc {

/// The names of a waypoint and its parts in messages.
struct WaypointNames {
  const char* whole;
  const char* position;
  const char* velocity;
  const char* acceleration;
};

/// The library's view of one waypoint of a C program. Values with a stride are copied into this
/// object, which must outlive the view.
class WaypointView {
 public:
  WaypointView(const splinecast_waypoint* waypoint, std::size_t dimensions,
               const WaypointNames& names);
  WaypointView(const WaypointView&) = delete;
  WaypointView& operator=(const WaypointView&) = delete;

  [[nodiscard]] const Waypoint& waypoint() const noexcept { return waypoint_; }

 private:
  /// A part as a span; copied if it has a stride.
  std::span<const double> view(const Values& values, std::size_t derivative) noexcept;

  Waypoint waypoint_{};
  std::array<double, 3 * kMaxDimensions> copies_;  ///< only what is copied is written
};

/// Waypoints in columns, checked: all that are given have one row per time.
struct Columns {
  Stamps times;
  Rows<const double> positions;
  Rows<const double> velocities;
  Rows<const double> accelerations;
  std::size_t dimensions = 0;

  [[nodiscard]] std::size_t size() const noexcept { return times.size(); }
};

/// Checks waypoints of `dimensions` dimensions.
[[nodiscard]] Columns require_columns(const splinecast_waypoints* waypoints,
                                      std::size_t dimensions);

/// Views of many waypoints. Keeps its memory for the next call.
class WaypointList {
 public:
  /// Calls `append` with each waypoint while it returns true. Does not allocate.
  template <typename Append>
  static void for_each(const Columns& columns, const Append& append) {
    std::array<double, 3 * kMaxDimensions> copies;
    for (std::size_t i = 0; i < columns.size(); ++i) {
      if (!append(row(columns, i, copies.data()))) return;
    }
  }

  /// The waypoints of a replacement, valid until the next call; null: without any. Nothing if there
  /// are more than any ring can hold. Allocates to grow.
  [[nodiscard]] std::optional<std::span<const Waypoint>> replacement(
      const splinecast_waypoints* waypoints, std::size_t dimensions);

 private:
  std::span<const Waypoint> all(const Columns& columns);
  /// Waypoint i; `copies` has room for the values of one.
  static Waypoint row(const Columns& columns, std::size_t i, double* copies) noexcept;

  std::vector<Waypoint> waypoints_;
  std::vector<double> copies_;
};

/// All columns as the library takes them for a fit. Copies the times, and values with a stride.
class Recording {
 public:
  explicit Recording(const splinecast_waypoints* waypoints);
  Recording(const Recording&) = delete;
  Recording& operator=(const Recording&) = delete;

  [[nodiscard]] const Waypoints& waypoints() const noexcept { return waypoints_; }

 private:
  std::vector<Time> times_;
  std::array<std::vector<double>, 3> copies_;
  Waypoints waypoints_{};
};

}  // namespace splinecast::ipc
