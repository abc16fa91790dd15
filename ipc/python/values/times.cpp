#include "ipc/python/values/times.hpp"

#include <chrono>
#include <cmath>
#include <string>

#include "core/basics/number_text.hpp"
#include "ipc/python/values/types.hpp"
#include "splinecast/clock.hpp"
#include "splinecast/errors.hpp"
#include "splinecast/waypoint.hpp"

namespace splinecast::python {
namespace {

constexpr double kNsPerSecond = 1e9;
constexpr double kLatestNs = 4611686018427387903.0;  // 2⁶² after rounding to a double
static_assert(kLatestTime.count() == 4611686018427387903);

std::string text_of(py::handle value) { return std::string(py::repr(value)); }

std::string type_name(py::handle value) { return Py_TYPE(value.ptr())->tp_name; }

[[noreturn]] void refuse_type(py::handle value) {
  throw py::type_error("a time is an int (ns) or a float (s), not " + type_name(value) + ' ' +
                       text_of(value));
}

[[noreturn]] void refuse_range(const std::string& value) {
  throw BadRequest("time " + value + " is not within ±4611686018427387903 ns (4.6e9 s)");
}

Time instant_of_int(py::handle value) {
  int overflow = 0;
  const long long ns = PyLong_AsLongLongAndOverflow(value.ptr(), &overflow);
  if (ns == -1 && PyErr_Occurred() != nullptr) throw py::error_already_set();
  if (overflow != 0 || !is_time_in_range(Time(ns))) refuse_range(text_of(value) + " ns");
  return Time(ns);
}

/// float16 and float32 do not hold instants: float32 has steps of 8 ms after a day.
void require_double(py::handle type, py::ssize_t itemsize) {
  if (itemsize >= static_cast<py::ssize_t>(sizeof(double))) return;
  throw py::type_error(text_of(type) +
                       " is too coarse for times: use float64 (s) or integers (ns)");
}

bool is_numpy(py::handle value, const char* kind) {
  return PyObject_IsInstance(value.ptr(), type(kind).ptr()) == 1;
}

/// Whether ints (1) or floats (0) are in a list of Python numbers. 0 is both. Other items: nothing.
std::optional<bool> are_ints(py::handle list) {
  const auto size = static_cast<std::size_t>(PySequence_Fast_GET_SIZE(list.ptr()));
  const std::span items(PySequence_Fast_ITEMS(list.ptr()), size);
  std::size_t ints = 0;
  std::size_t floats = 0;
  for (std::size_t i = 0; i < items.size(); ++i) {
    const bool is_int = PyLong_Check(items[i]) && !PyBool_Check(items[i]);
    if (!is_int && !PyFloat_Check(items[i])) return std::nullopt;
    floats += static_cast<std::size_t>(!is_int);
    ints += static_cast<std::size_t>(is_int && PyObject_IsTrue(items[i]) == 1);
    if (ints == 0 || floats == 0) continue;
    throw py::type_error("times mix int (ns) and float (s): " + text_of(items[i]) +
                         " is at index " + std::to_string(i));
  }
  return floats == 0;
}

py::array contiguous(py::handle values, const py::dtype& type) {
  auto& api = py::detail::npy_api::get();
  PyObject* const array = api.PyArray_FromAny_(values.ptr(), type.inc_ref().ptr(), 0, 0,
                                               py::detail::npy_api::NPY_ARRAY_C_CONTIGUOUS_ |
                                                   py::detail::npy_api::NPY_ARRAY_ALIGNED_ |
                                                   py::detail::npy_api::NPY_ARRAY_FORCECAST_,
                                               nullptr);
  if (array == nullptr) throw py::error_already_set();
  return py::reinterpret_steal<py::array>(array);
}

py::array as_array(py::handle values) {
  if (py::isinstance<py::array>(values)) return py::reinterpret_borrow<py::array>(values);
  if (PyList_Check(values.ptr()) || PyTuple_Check(values.ptr())) {
    const auto ints = are_ints(values);
    if (ints)
      return contiguous(values, *ints ? py::dtype::of<std::int64_t>() : py::dtype::of<double>());
  }
  py::array array = py::array::ensure(values);
  if (!array) throw py::error_already_set();
  return array;
}

}  // namespace

Time instant_of_seconds(double seconds) {
  const double ns = seconds * kNsPerSecond;
  if (!(std::abs(ns) < kLatestNs)) refuse_range(core::number_text(seconds) + " s");
  return Time(std::llrint(ns));
}

Time instant(py::handle value) {
  PyObject* const object = value.ptr();
  if (PyFloat_Check(object)) return instant_of_seconds(PyFloat_AS_DOUBLE(object));
  if (PyLong_Check(object) && !PyBool_Check(object)) return instant_of_int(value);
  if (is_numpy(value, "floating")) {
    require_double(value.attr("dtype"), value.attr("itemsize").cast<py::ssize_t>());
    return instant_of_seconds(PyFloat_AsDouble(object));
  }
  if (!is_numpy(value, "integer")) refuse_type(value);
  return instant_of_int(py::reinterpret_steal<py::object>(PyNumber_Index(object)));
}

Time instant_or_soonest(py::handle value) { return value.is_none() ? Time::min() : instant(value); }

Time duration(py::handle value, const char* what) {
  const bool is_number =
      PyFloat_Check(value.ptr()) || PyIndex_Check(value.ptr()) != 0 || is_numpy(value, "floating");
  if (!is_number || PyBool_Check(value.ptr())) {
    throw py::type_error(std::string(what) + " is a number of seconds, not " + type_name(value) +
                         ' ' + text_of(value));
  }
  const double seconds = PyFloat_AsDouble(value.ptr());
  if (seconds == -1 && PyErr_Occurred() != nullptr) throw py::error_already_set();
  if (!(seconds >= 0)) {
    throw BadRequest(std::string(what) + " must be 0 s or more, not " + text_of(value));
  }
  const double ns = seconds * kNsPerSecond;
  if (ns >= 9.2e18) return Time::max();
  return Time(ns > 0 ? std::max(std::llrint(ns), 1LL) : 0);
}

std::optional<Time> optional_duration(py::handle value, const char* what) {
  if (value.is_none()) return std::nullopt;
  return duration(value, what);
}

void require_near_now(Time time) {
  constexpr Time kFar = std::chrono::hours(1);
  const Time now = MonotonicClock().now();
  if (time >= now - kFar && time <= now + kFar) return;
  throw BadRequest("a sample more than an hour from now: time " + compared_with_now(time));
}

py::object optional_ns(Time time) {
  if (time == Time::min() || time == Time::max()) return py::none();
  return py::int_(time.count());
}

Instants::Instants(py::handle values) : array_(as_array(values)) {
  const char kind = array_.dtype().kind();
  is_seconds_ = kind == 'f';
  if (kind != 'f' && kind != 'i' && kind != 'u') {
    throw py::type_error("times are an array of ints (ns) or of floats (s), not of " +
                         text_of(array_.dtype()));
  }
  if (is_seconds_) require_double(array_.dtype(), array_.itemsize());
  if (kind == 'u' && array_.itemsize() == 8) {
    const py::object largest = array_.size() > 0 ? array_.attr("max")() : py::int_(0);
    (void)instant(largest);
  }
  array_ =
      contiguous(array_, is_seconds_ ? py::dtype::of<double>() : py::dtype::of<std::int64_t>());
}

std::span<const double> Instants::seconds() const {
  return {static_cast<const double*>(array_.data()), size()};
}

std::span<const Time> Instants::times(std::vector<Time>& scratch) const {
  if (!is_seconds_) {
    static_assert(sizeof(Time) == sizeof(std::int64_t));
    const std::span<const Time> given(static_cast<const Time*>(array_.data()), size());
    for (const Time time : given) {
      if (!is_time_in_range(time)) refuse_range(std::to_string(time.count()) + " ns");
    }
    return given;
  }
  scratch.resize(size());
  for (std::size_t i = 0; i < size(); ++i) scratch[i] = instant_of_seconds(seconds()[i]);
  return scratch;
}

void Instants::require_line() const {
  if (array_.ndim() == 1) return;
  throw BadRequest("times must have one dimension, not shape " + text_of(array_.attr("shape")));
}

}  // namespace splinecast::python
