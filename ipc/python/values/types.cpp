#include "ipc/python/values/types.hpp"

#include <pybind11/numpy.h>

#include <array>
#include <stdexcept>

#include "splinecast/errors.hpp"

namespace splinecast::python {
namespace {

/// Never destroyed: the interpreter may end before the static objects do.
struct Types {
  py::dict by_name;
  std::array<PyObject*, kSampleStatuses> sample_status{};
};

Types* types = nullptr;

/// The name of the Python class for a C++ exception; nullptr for one that pybind11 translates.
const char* class_of(const std::exception& failure) {
  const auto is = [&failure]<typename Failure>(const Failure*) {
    return dynamic_cast<const Failure*>(&failure) != nullptr;
  };
  if (is(static_cast<NoSuchStream*>(nullptr))) return "NoSuchStream";
  if (is(static_cast<StreamBusy*>(nullptr))) return "StreamBusy";
  if (is(static_cast<OutOfResources*>(nullptr))) return "OutOfResources";
  if (is(static_cast<BadRegion*>(nullptr))) return "BadRegion";
  if (is(static_cast<BadRequest*>(nullptr))) return "BadRequest";
  if (is(static_cast<std::invalid_argument*>(nullptr))) return "BadRequest";
  if (is(static_cast<StreamError*>(nullptr))) return "Error";
  return nullptr;
}

void translate(std::exception_ptr failure) {
  try {
    std::rethrow_exception(std::move(failure));
  } catch (const py::builtin_exception&) {
    throw;  // such as TypeError, which is a std::runtime_error too
  } catch (const std::exception& known) {
    const char* const name = class_of(known);
    if (name == nullptr) throw;
    PyErr_SetString(type(name).ptr(), known.what());
  }
}

std::string text_of(std::span<const double> values) {
  std::string text = "[";
  for (const double value : values) {
    text += (text.size() > 1 ? ", " : "") + std::string(py::repr(py::float_(value)));
  }
  return text + "]";
}

}  // namespace

void import_types() {
  types = new Types;
  for (const char* name : {"splinecast.errors", "splinecast.statuses", "splinecast.records"}) {
    types->by_name.attr("update")(py::module_::import(name).attr("__dict__"));
  }
  for (const char* name : {"floating", "integer"}) {
    types->by_name[name] = py::module_::import("numpy").attr(name);
  }
  for (std::uint8_t i = 0; i < kSampleStatuses; ++i) {
    types->sample_status[i] = member("SampleStatus", i).release().ptr();
  }
  py::register_exception_translator(translate);
}

py::handle type(const char* name) {
  const py::handle found = PyDict_GetItemString(types->by_name.ptr(), name);
  if (!found) throw std::runtime_error(std::string("the package lacks the class ") + name);
  return found;
}

py::object member(const char* enumeration, std::uint8_t number) {
  return type(enumeration)(number);
}

py::object member(SampleStatus status) {
  return py::reinterpret_borrow<py::object>(types->sample_status[static_cast<std::size_t>(status)]);
}

py::object to_exception(const std::exception& failure) {
  const char* const name = class_of(failure);
  return name != nullptr ? type(name)(failure.what())
                         : py::handle(PyExc_RuntimeError)(failure.what());
}

void throw_refused(const NotAccepted& item) {
  const bool is_full = item.status == AppendStatus::full;
  std::string text = item.what + (" refused: " + std::string(to_string(item.status)));
  if (item.index) text += " (waypoint " + std::to_string(*item.index) + ')';
  if (item.time) text += ", time " + std::to_string(item.time->count()) + " ns";
  if (!item.position.empty()) text += ", position " + text_of(item.position);
  if (!item.reason.empty()) text += ": " + item.reason;
  const py::object failure = type(is_full ? "Full" : "Refused")(text);
  failure.attr("status") = member("AppendStatus", static_cast<std::uint8_t>(item.status));
  if (item.time) failure.attr("time") = item.time->count();
  if (!item.position.empty()) {
    failure.attr("position") =
        py::array_t<double>(static_cast<py::ssize_t>(item.position.size()), item.position.data());
  }
  if (item.index) failure.attr("index") = *item.index;
  PyErr_SetObject(type(is_full ? "Full" : "Refused").ptr(), failure.ptr());
  throw py::error_already_set();
}

}  // namespace splinecast::python
