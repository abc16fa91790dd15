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

Path::Path(std::size_t dimensions, py::handle times, py::handle positions, py::handle velocities,
           py::handle accelerations)
    : position(positions, "positions"),
      velocity(velocities, "velocities"),
      acceleration(accelerations, "accelerations") {
  if (times.is_none()) {
    position.require(0, 0, true);
    return;
  }
  const Instants instants(times);
  instants.require_line();
  const auto ns = instants.times(scratch);
  position.require(ns.size(), dimensions, ns.empty());
  velocity.require(ns.size(), dimensions, true);
  acceleration.require(ns.size(), dimensions, true);
  const Waypoints all{.dimensions = dimensions,
                      .times = ns,
                      .positions = position.all(),
                      .velocities = velocity.all(),
                      .accelerations = acceleration.all()};
  for (std::size_t i = 0; i < ns.size(); ++i) waypoints.push_back(all[i]);
}

}  // namespace splinecast::python
