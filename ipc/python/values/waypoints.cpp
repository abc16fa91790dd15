#include "ipc/python/values/waypoints.hpp"

namespace splinecast::python {

GivenWaypoints::GivenWaypoints(py::handle times, py::handle positions, py::handle velocities,
                               py::handle accelerations, std::size_t dimensions)
    : instants_(times),
      rows_{Rows(positions, "positions"), Rows(velocities, "velocities"),
            Rows(accelerations, "accelerations")} {
  instants_.require_line();
  times_ = instants_.times(scratch_);
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    rows_[r].require(times_.size(), dimensions, r > 0);
  }
}

}  // namespace splinecast::python
