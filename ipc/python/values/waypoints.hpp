#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "ipc/python/values/arrays.hpp"
#include "ipc/python/values/times.hpp"
#include "splinecast/state.hpp"
#include "splinecast/time.hpp"
#include "splinecast/waypoint.hpp"

namespace splinecast::python {

/// Waypoints that are read where they are; a row that is not contiguous is copied.
class GivenWaypoints {
 public:
  /// Raises for arrays that are not n times and n rows of D values; velocities and accelerations
  /// may be None.
  GivenWaypoints(py::handle times, py::handle positions, py::handle velocities,
                 py::handle accelerations, std::size_t dimensions);

  [[nodiscard]] std::size_t size() const { return times_.size(); }

  /// Valid until the next call.
  [[nodiscard]] Waypoint operator[](std::size_t i) {
    return {
        .time = times_[i], .position = row(0, i), .velocity = row(1, i), .acceleration = row(2, i)};
  }

 private:
  std::span<const double> row(std::size_t r, std::size_t i) {
    if (rows_[r].empty()) return {};
    return rows_[r].row(i, copies_[r]);
  }

  Instants instants_;
  std::array<Rows, 3> rows_;
  std::vector<Time> scratch_;
  std::span<const Time> times_;
  std::array<std::array<double, kMaxDimensions>, 3> copies_{};
};

/// Waypoints from arrays. Their spans point into the arrays, or into copies of what is not
/// contiguous.
struct Path {
  Path(std::size_t dimensions, py::handle times, py::handle positions, py::handle velocities,
       py::handle accelerations);

  Rows position;
  Rows velocity;
  Rows acceleration;
  std::vector<Time> scratch;
  std::vector<Waypoint> waypoints;
};

}  // namespace splinecast::python
