#include "ipc/python/segments.hpp"

#include <pybind11/stl.h>

#include "ipc/python/curve.hpp"
#include "ipc/python/docstrings.hpp"
#include "ipc/python/module.hpp"
#include "ipc/python/values/records.hpp"
#include "ipc/python/values/times.hpp"
#include "ipc/python/values/types.hpp"
#include "splinecast/errors.hpp"

namespace splinecast::python {
namespace {

py::list segments(const Segments& self) {
  py::list found;
  for (std::size_t i = 0; i < self.snapshot.size(); ++i) {
    found.append(to_record(self.snapshot[i], self.snapshot.dimensions()));
  }
  return found;
}

Curve curve(const Segments& self) {
  if (self.snapshot.size() == 0) {
    throw BadRequest("the snapshot has no segments: " + std::string(to_string(self.status)));
  }
  PiecewisePolynomial polynomial(self.snapshot.dimensions());
  for (std::size_t i = 0; i < self.snapshot.size(); ++i) {
    const SnapshotSegment segment = self.snapshot[i];
    polynomial.append(segment.left, segment.right, segment.order, segment.coefficients);
  }
  return Curve(std::move(polynomial), TimeScale(), {});
}

}  // namespace

void define_snapshot(py::module_& module) {
  py::class_<Segments>(module, "Snapshot", doc::Snapshot)
      .def_property_readonly(
          "status", [](const Segments& self) { return member(self.status); }, doc::Snapshot_status)
      .def_property_readonly(
          "revision", [](const Segments& self) { return self.snapshot.revision(); },
          doc::Snapshot_revision)
      .def_property_readonly(
          "settled_until",
          [](const Segments& self) { return optional_ns(self.snapshot.settled_until()); },
          doc::Snapshot_settled_until)
      .def_property_readonly("segments", &segments, doc::Snapshot_segments)
      .def("curve", &curve, doc::Snapshot_curve)
      .def(
          "to_ppoly",
          [](const Segments& self, py::handle origin) { return curve(self).to_ppoly(origin); },
          py::arg("origin") = 0, doc::Snapshot_to_ppoly)
      .def(
          "__len__", [](const Segments& self) { return self.snapshot.size(); }, doc::Snapshot_len)
      .def("__repr__", [](const Segments& self) {
        return "<splinecast.Snapshot of " + std::to_string(self.snapshot.size()) +
               " segments, revision " + std::to_string(self.snapshot.revision()) + '>';
      });
}

}  // namespace splinecast::python
