#include "ipc/python/values/options.hpp"

#include <pybind11/stl.h>

#include <array>
#include <limits>
#include <utility>

#include "ipc/python/values/arrays.hpp"
#include "ipc/python/values/times.hpp"
#include "splinecast/errors.hpp"

namespace splinecast::python {
namespace {

std::string text_of(py::handle value) { return std::string(py::repr(value)); }

/// Calls `take` with a keyword's value unless that is missing or None.
template <typename Take>
void with(const py::kwargs& keywords, const char* name, const Take& take) {
  if (!keywords.contains(name)) return;
  const py::object value = keywords[name];
  if (!value.is_none()) take(value);
}

template <typename Value>
Value as(const py::object& value, const char* name) {
  try {
    return value.cast<Value>();
  } catch (const py::cast_error&) {
    throw py::type_error(std::string(name) + ": " + text_of(value) + " has a wrong type or range");
  }
}

std::size_t count(const py::object& value, const char* name) {
  if (PyIndex_Check(value.ptr()) == 0 || PyBool_Check(value.ptr())) {
    throw py::type_error(std::string(name) + " is an int, not " + text_of(value));
  }
  const auto number = as<long long>(value, name);
  if (number < 0) {
    throw BadRequest(std::string(name) + " must be 0 or more, not " + text_of(value));
  }
  return static_cast<std::size_t>(number);
}

/// Texts: one for all of `dimensions`, or a sequence.
std::vector<std::string> texts(const py::object& value, std::size_t dimensions, const char* name) {
  if (!py::isinstance<py::str>(value)) return as<std::vector<std::string>>(value, name);
  std::vector<std::string> same;
  same.assign(dimensions, value.cast<std::string>());
  return same;
}

Dimension kind(const std::string& text) {
  const auto parsed = parse_dimension(text);
  if (parsed) return *parsed;
  throw BadRequest("kinds: '" + text +
                   "' is not linear, periodic:PERIOD, quaternion or quaternion-wxyz");
}

std::size_t dimensions(const py::kwargs& keywords) {
  std::size_t found = 1;
  const auto length = [&](const py::object& v) {
    if (!py::isinstance<py::str>(v)) found = py::len(v);
  };
  with(keywords, "kinds", length);
  with(keywords, "names", length);
  with(keywords, "dimensions", [&](const py::object& v) { found = count(v, "dimensions"); });
  if (found >= kMinDimensions && found <= kMaxDimensions) return found;
  throw BadRequest("dimensions must be 1 to 64, not " + std::to_string(found));
}

StreamClock clock(const std::string& text) {
  if (text == "monotonic") return StreamClock::monotonic;
  if (text == "recorded") return StreamClock::recorded;
  if (text == "law") return StreamClock::law;
  throw BadRequest("clock: '" + text + "' is not monotonic, recorded or law");
}

double number(const py::object& value, const char* name) {
  const double number = PyFloat_AsDouble(value.ptr());
  if (number != -1 || PyErr_Occurred() == nullptr) return number;
  PyErr_Clear();
  throw py::type_error(std::string(name) + " is a number, not " + text_of(value));
}

std::vector<double> limit_values(const py::object& value, const std::string& name) {
  const Row row(value, name.c_str());
  return {row.values().begin(), row.values().end()};
}

[[noreturn]] void refuse_limit(const std::string& name) {
  throw BadRequest("limits: '" + name + "' is not velocity, acceleration, jerk, lower or upper");
}

MotionLimits limits(const py::object& value) {
  MotionLimits found;
  for (const auto& [key, values] : as<py::dict>(py::dict(value), "limits")) {
    const auto name = key.cast<std::string>();
    auto list = limit_values(py::reinterpret_borrow<py::object>(values), name);
    if (name == "velocity")
      found.velocity = std::move(list);
    else if (name == "acceleration")
      found.acceleration = std::move(list);
    else if (name == "jerk")
      found.jerk = std::move(list);
    else if (name == "lower")
      found.lower = std::move(list);
    else if (name == "upper")
      found.upper = std::move(list);
    else
      refuse_limit(name);
  }
  return found;
}

NamedLimits limits_of(const std::string& dimension, const py::dict& kinds) {
  NamedLimits found{.name = dimension};
  for (const auto& [key, value] : kinds) {
    const auto name = key.cast<std::string>();
    const double limit = number(py::reinterpret_borrow<py::object>(value), name.c_str());
    if (name == "velocity")
      found.velocity = limit;
    else if (name == "acceleration")
      found.acceleration = limit;
    else if (name == "jerk")
      found.jerk = limit;
    else if (name == "lower")
      found.lower = limit;
    else if (name == "upper")
      found.upper = limit;
    else
      refuse_limit(name);
  }
  return found;
}

Tail tail(const std::string& text) {
  const auto parsed = parse_tail(text);
  if (parsed) return *parsed;
  throw BadRequest("tail: '" + text + "' is not bessel, parabolic, natural or clamped");
}

Beyond beyond(const std::string& text) {
  if (const auto parsed = parse_beyond(text)) return *parsed;
  throw BadRequest("beyond: '" + text + "' is not report, refuse or enter");
}

void read_times(const py::kwargs& keywords, SolverOptions& options) {
  const std::array<std::pair<const char*, std::optional<Time>*>, 4> times{
      {{"stop_time", &options.stop_time},
       {"freeze_ahead", &options.freeze_ahead},
       {"history", &options.history},
       {"min_entry", &options.min_entry}}};
  for (const auto& [name, time] : times) {
    with(keywords, name, [&, n = name, t = time](const py::object& v) { *t = duration(v, n); });
  }
}

void read_limits(const py::kwargs& keywords, SolverOptions& options) {
  with(keywords, "limits", [&](const py::object& v) { options.limits = limits(v); });
  with(keywords, "named_limits", [&](const py::object& v) {
    for (const auto& [name, kinds] : py::dict(v)) {
      options.named_limits.push_back(
          limits_of(name.cast<std::string>(), py::reinterpret_borrow<py::dict>(kinds)));
    }
  });
  with(keywords, "beyond",
       [&](const py::object& v) { options.beyond = beyond(as<std::string>(v, "beyond")); });
}

}  // namespace

Condition condition(py::handle value) {
  if (value.is_none()) return {.kind = ConditionKind::own, .value = {}};
  if (py::isinstance<py::str>(value)) {
    const auto parsed = parse_condition(value.cast<std::string>());
    if (parsed) return *parsed;
  } else if (py::isinstance<py::tuple>(value) && py::len(value) == 2) {
    const std::string name = py::str(value[py::int_(0)]);
    const Row row(value[py::int_(1)], "boundary condition");
    std::vector<double> values(row.values().begin(), row.values().end());
    if (name == "velocity") return {ConditionKind::velocity, std::move(values)};
    if (name == "acceleration") return {ConditionKind::acceleration, std::move(values)};
  }
  throw BadRequest("boundary condition " + text_of(value) +
                   " is not natural, clamped, halt, velocity=…, acceleration=…, not-a-knot, "
                   "periodic, or a pair such as ('velocity', values)");
}

const Method& method(const std::string& name) {
  const Method* const found = find_method(name);
  if (found != nullptr) return *found;
  throw BadRequest("there is no method '" + name + "'; there are " + method_names(false));
}

Trust trust(py::handle owner) {
  if (owner.is_none()) return {};
  return {.owner = static_cast<uid_t>(count(py::reinterpret_borrow<py::object>(owner), "owner"))};
}

RegionAccess access(const py::kwargs& keywords, Trust& trusted) {
  RegionAccess access;
  with(keywords, "mode",
       [&](const py::object& v) { access.mode = static_cast<mode_t>(count(v, "mode")); });
  with(keywords, "group",
       [&](const py::object& v) { access.group = static_cast<gid_t>(count(v, "group")); });
  with(keywords, "owner", [&](const py::object& v) { trusted = trust(v); });
  return access;
}

ProducerOptions producer_options(const py::kwargs& keywords) {
  ProducerOptions options;
  options.dimensions = dimensions(keywords);
  with(keywords, "names",
       [&](const py::object& v) { options.names = as<std::vector<std::string>>(v, "names"); });
  with(keywords, "units",
       [&](const py::object& v) { options.units = texts(v, options.dimensions, "units"); });
  with(keywords, "kinds", [&](const py::object& v) {
    for (const std::string& text : texts(v, options.dimensions, "kinds")) {
      options.kinds.push_back(kind(text));
    }
  });
  with(keywords, "law", [&](const py::object& v) {
    options.law = as<std::string>(v, "law");
    options.clock = StreamClock::law;
  });
  with(keywords, "clock",
       [&](const py::object& v) { options.clock = clock(as<std::string>(v, "clock")); });
  with(keywords, "start", [&](const py::object& v) { options.start = condition(v); });
  with(keywords, "min_interval",
       [&](const py::object& v) { options.limits.min_interval = duration(v, "min_interval"); });
  with(keywords, "max_interval",
       [&](const py::object& v) { options.limits.max_interval = duration(v, "max_interval"); });
  with(keywords, "horizon", [&](const py::object& v) { options.horizon = duration(v, "horizon"); });
  with(keywords, "start_tolerance",
       [&](const py::object& v) { options.start_tolerance = as<double>(v, "start_tolerance"); });
  with(keywords, "capacity", [&](const py::object& v) { options.capacity = count(v, "capacity"); });
  options.access = access(keywords, options.trust);
  return options;
}

SolverOptions solver_options(const py::kwargs& keywords) {
  SolverOptions options;
  with(keywords, "method",
       [&](const py::object& v) { options.method = &method(as<std::string>(v, "method")); });
  with(keywords, "lam", [&](const py::object& v) { options.lambda = number(v, "lam"); });
  with(keywords, "time_scale",
       [&](const py::object& v) { options.time_scale = number(v, "time_scale"); });
  with(keywords, "largest_rate",
       [&](const py::object& v) { options.largest_rate = number(v, "largest_rate"); });
  with(keywords, "settle", [&](const py::object& v) { options.settle = count(v, "settle"); });
  with(keywords, "tail",
       [&](const py::object& v) { options.tail = tail(as<std::string>(v, "tail")); });
  with(keywords, "force_lag",
       [&](const py::object& v) { options.force_lag = as<bool>(v, "force_lag"); });
  with(keywords, "wake", [&](const py::object& v) { options.wake = as<bool>(v, "wake"); });
  with(keywords, "capacity", [&](const py::object& v) { options.capacity = count(v, "capacity"); });
  read_times(keywords, options);
  read_limits(keywords, options);
  options.access = access(keywords, options.trust);
  return options;
}

}  // namespace splinecast::python
