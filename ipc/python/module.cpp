#include "ipc/python/module.hpp"

#include <pybind11/stl.h>

#include <algorithm>

#include "ipc/python/docstrings.hpp"
#include "ipc/python/held.hpp"
#include "ipc/python/values/options.hpp"
#include "ipc/python/values/types.hpp"
#include "splinecast/streams.hpp"

namespace splinecast::python {

void require_keywords(const py::kwargs& keywords, const char* function,
                      std::span<const std::string> known) {
  for (const auto& [key, value] : keywords) {
    const auto name = key.cast<std::string>();
    if (std::ranges::find(known, name) != known.end()) continue;
    throw py::type_error(std::string(function) + "() has no keyword '" + name + "'");
  }
}

namespace {

void define_streams(py::module_& module) {
  module.def("streams", &stream_names, doc::streams);
  module.def(
      "remove",
      [](const std::string& stream, py::handle owner) {
        const Trust trusted = trust(owner);
        without_gil([&] { remove_stream(stream, trusted); });
      },
      py::arg("stream"), py::arg("owner") = py::none(), doc::remove);
}

}  // namespace
}  // namespace splinecast::python

PYBIND11_MODULE(_splinecast, module) {
  using namespace splinecast::python;
  pybind11::options options;
  options.disable_function_signatures();  // the docstrings begin with one
  module.doc() = "The C++ part of splinecast.";
  module.attr("__version__") = SPLINECAST_VERSION;
  import_types();
  define_producer(module);
  define_solver(module);
  define_samples(module);
  define_reader(module);
  define_rate_commander(module);
  define_stopper(module);
  define_curve(module);
  define_snapshot(module);
  define_fit(module);
  define_streams(module);
}
