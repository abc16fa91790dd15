#pragma once

#include <pybind11/pybind11.h>

#include <string>
#include <vector>

#include "splinecast/boundary_condition.hpp"
#include "splinecast/method.hpp"
#include "splinecast/options.hpp"

/// Options of the roles and of fits from keyword arguments. Functions throw BadRequest or TypeError
/// with the value. A keyword that is missing, or None, leaves the default.
namespace splinecast::python {

namespace py = pybind11;

/// A boundary condition: its text, or a pair of its name and values. None: the method's own.
[[nodiscard]] Condition condition(py::handle value);

/// A method by its name.
[[nodiscard]] const Method& method(const std::string& name);

/// The keywords of the constructors of RateCommander and Stopper, of Producer, and of Solver.
[[nodiscard]] std::vector<std::string> access_keywords();
[[nodiscard]] std::vector<std::string> producer_keywords();
[[nodiscard]] std::vector<std::string> solver_keywords();

[[nodiscard]] ProducerOptions producer_options(const py::kwargs& keywords);
[[nodiscard]] SolverOptions solver_options(const py::kwargs& keywords);
[[nodiscard]] Trust trust(py::handle owner);

/// The keywords mode and group; writes the keyword owner to `trusted`.
[[nodiscard]] RegionAccess access(const py::kwargs& keywords, Trust& trusted);

}  // namespace splinecast::python
