#pragma once

#include <pybind11/pybind11.h>

#include <span>
#include <string>

/// The parts of the extension module.
namespace splinecast::python {

namespace py = pybind11;

void define_producer(py::module_& module);
void define_solver(py::module_& module);
void define_samples(py::module_& module);
void define_reader(py::module_& module);
void define_rate_commander(py::module_& module);
void define_stopper(py::module_& module);
void define_snapshot(py::module_& module);
void define_curve(py::module_& module);
void define_fit(py::module_& module);

/// Throws TypeError for a keyword that is not one of these.
void require_keywords(const py::kwargs& keywords, const char* function,
                      std::span<const std::string> known);

}  // namespace splinecast::python
