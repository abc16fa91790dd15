#pragma once

#include <pybind11/pybind11.h>

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "splinecast/status.hpp"
#include "splinecast/time.hpp"

/// The exceptions, enumerations and records of the package, which are written in Python.
namespace splinecast::python {

namespace py = pybind11;

/// Imports them and translates the exceptions of the C++ interface. Call it first.
void import_types();

/// A class of errors.py, statuses.py or records.py by its name, or `floating` or `integer` of
/// numpy: a search in a dictionary.
[[nodiscard]] py::handle type(const char* name);

/// The member of an enumeration for a number.
[[nodiscard]] py::object member(const char* enumeration, std::uint8_t number);
/// The same, at once: for every sample.
[[nodiscard]] py::object member(SampleStatus status);

/// The Python exception for a C++ exception.
[[nodiscard]] py::object to_exception(const std::exception& failure);

/// An item that the ring did not accept.
struct NotAccepted {
  const char* what;  ///< `waypoint`, `replacement`, …
  AppendStatus status;
  std::optional<Time> time{};
  std::span<const double> position{};
  std::optional<std::size_t> index{};
  std::string reason{};  ///< what is known in addition to the status
};

/// Raises Refused, or Full.
[[noreturn]] void throw_refused(const NotAccepted& item);

}  // namespace splinecast::python
