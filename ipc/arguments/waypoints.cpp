#include "ipc/arguments/waypoints.hpp"

#include <string>

#include "ipc/arguments/guard.hpp"
#include "ipc/layout/waypoint_items.hpp"

namespace splinecast::ipc {
namespace {

Rows<const double> require_rows(const splinecast_matrix& matrix, const Columns& of,
                                const char* name, bool is_optional) {
  if (!is_optional && of.size() > 0) require_pointer(matrix.data, name);
  const Rows<const double> rows(matrix.data, matrix.rows, matrix.columns, matrix.row_stride,
                                matrix.column_stride, name);
  if (!rows.given()) return rows;
  if (matrix.rows != of.size()) {
    refuse(name, "has " + std::to_string(matrix.rows) + " rows, not one for each of " +
                     std::to_string(of.size()) + " times");
  }
  if (matrix.columns != of.dimensions) {
    refuse(name, "has " + std::to_string(matrix.columns) + " columns, not " +
                     std::to_string(of.dimensions));
  }
  return rows;
}

/// A row as a span; copied if it has a stride.
std::span<const double> row_of(const Rows<const double>& rows, std::size_t i, std::size_t columns,
                               double* copy) noexcept {
  if (!rows.given()) return {};
  if (rows.has_contiguous_rows()) return rows.row(i);
  for (std::size_t d = 0; d < columns; ++d) copy[d] = rows.at(i, d);
  return {copy, columns};
}

/// All values of a matrix as a span; copied to `copy` if they are not contiguous.
std::span<const double> values_of(const Rows<const double>& rows, std::size_t columns,
                                  std::vector<double>& copy) {
  if (rows.is_contiguous()) return rows.span();
  copy.resize(rows.size() * columns);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    for (std::size_t d = 0; d < columns; ++d) copy[i * columns + d] = rows.at(i, d);
  }
  return copy;
}

}  // namespace

WaypointView::WaypointView(const splinecast_waypoint* waypoint, std::size_t dimensions,
                           const WaypointNames& names) {
  require_pointer(waypoint, names.whole);
  waypoint_.time = Time(waypoint->time);
  waypoint_.position = view(require_vector(waypoint->position, dimensions, names.position), 0);
  waypoint_.velocity = view(optional_vector(waypoint->velocity, dimensions, names.velocity), 1);
  waypoint_.acceleration =
      view(optional_vector(waypoint->acceleration, dimensions, names.acceleration), 2);
}

std::span<const double> WaypointView::view(const Values& values, std::size_t derivative) noexcept {
  if (!values.given()) return {};
  if (values.is_contiguous()) return values.span();
  double* const copy = copies_.data() + derivative * kMaxDimensions;
  for (std::size_t d = 0; d < values.size(); ++d) copy[d] = values[d];
  return {copy, values.size()};
}

Columns require_columns(const splinecast_waypoints* waypoints, std::size_t dimensions) {
  require_pointer(waypoints, "waypoints");
  Columns found;
  found.times = require_times(waypoints->times, "waypoints->times");
  found.dimensions = dimensions;
  found.positions = require_rows(waypoints->positions, found, "waypoints->positions", false);
  found.velocities = require_rows(waypoints->velocities, found, "waypoints->velocities", true);
  found.accelerations =
      require_rows(waypoints->accelerations, found, "waypoints->accelerations", true);
  return found;
}

Waypoint WaypointList::row(const Columns& columns, std::size_t i, double* copies) noexcept {
  const std::size_t count = columns.dimensions;
  return {.time = Time(columns.times[i]),
          .position = row_of(columns.positions, i, count, copies),
          .velocity = row_of(columns.velocities, i, count, copies + count),
          .acceleration = row_of(columns.accelerations, i, count, copies + 2 * count)};
}

std::optional<std::span<const Waypoint>> WaypointList::replacement(
    const splinecast_waypoints* waypoints, std::size_t dimensions) {
  if (waypoints == nullptr) return std::span<const Waypoint>();
  const Columns columns = require_columns(waypoints, dimensions);
  if (columns.size() > kMaxRingCapacity) return std::nullopt;
  return all(columns);
}

std::span<const Waypoint> WaypointList::all(const Columns& columns) {
  const std::size_t size = 3 * columns.dimensions;
  const auto is_copied = [](const Rows<const double>& rows) {
    return rows.given() && !rows.has_contiguous_rows();
  };
  const bool copies = is_copied(columns.positions) || is_copied(columns.velocities) ||
                      is_copied(columns.accelerations);
  if (copies) copies_.resize(columns.size() * size);
  waypoints_.clear();
  for (std::size_t i = 0; i < columns.size(); ++i) {
    waypoints_.push_back(row(columns, i, copies_.data() + (copies ? i * size : 0)));
  }
  return waypoints_;
}

Recording::Recording(const splinecast_waypoints* waypoints) {
  const std::size_t dimensions = require_pointer(waypoints, "waypoints")->positions.columns;
  if (dimensions < kMinDimensions || dimensions > kMaxDimensions) {
    refuse("waypoints->positions", "has " + std::to_string(dimensions) + " columns, not 1 to 64");
  }
  const Columns columns = require_columns(waypoints, dimensions);
  times_.reserve(columns.size());
  for (std::size_t i = 0; i < columns.size(); ++i) {
    times_.emplace_back(columns.times[i]);
    if (is_time_in_range(times_.back())) continue;
    refuse("waypoints->times", "has " + std::to_string(columns.times[i]) + " ns at " +
                                   std::to_string(i) + ", outside of ±2^62");
  }
  waypoints_ = {.dimensions = dimensions,
                .times = times_,
                .positions = values_of(columns.positions, dimensions, copies_[0]),
                .velocities = values_of(columns.velocities, dimensions, copies_[1]),
                .accelerations = values_of(columns.accelerations, dimensions, copies_[2])};
}

}  // namespace splinecast::ipc
