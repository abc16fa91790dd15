#include "ipc/python/values/options.hpp"

#include <pybind11/stl.h>

#include <limits>
#include <optional>
#include <string_view>
#include <type_traits>
#include <utility>

#include "ipc/layout/options.hpp"
#include "ipc/python/values/arrays.hpp"
#include "ipc/python/values/times.hpp"
#include "splinecast/errors.hpp"

namespace splinecast::python {
namespace {

/// `lambda` is a word of the language.
std::string_view python_key(std::string_view key) { return key == "lambda" ? "lam" : key; }

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

/// Reads the keyword of an option into `out`, its value or an optional of it.
template <typename Row, typename Out>
void read_value(const Row& row, const std::string& key, const py::kwargs& keywords, Out& out) {
  using Value = typename Row::Value;
  const char* const name = key.c_str();
  with(keywords, name, [&](const py::object& value) {
    if constexpr (std::is_same_v<Value, Time>) {
      out = duration(value, name);
    } else if constexpr (std::is_same_v<Value, double>) {
      out = number(value, name);
    } else if constexpr (std::is_same_v<Value, std::size_t>) {
      out = count(value, name);
    } else if constexpr (std::is_same_v<Value, bool>) {
      out = as<bool>(value, name);
    } else {
      const auto text = as<std::string>(value, name);
      const auto parsed = ipc::value_of_word<Value>(text);
      if (!parsed) {
        throw BadRequest(key + ": '" + text + "' is not " + std::string(row.range.text));
      }
      out = *parsed;
    }
  });
}

void read_limits(const py::kwargs& keywords, SolverOptions& options) {
  with(keywords, "limits", [&](const py::object& v) { options.limits = limits(v); });
  with(keywords, "named_limits", [&](const py::object& v) {
    for (const auto& [name, kinds] : py::dict(v)) {
      options.named_limits.push_back(
          limits_of(name.cast<std::string>(), py::reinterpret_borrow<py::dict>(kinds)));
    }
  });
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
  ipc::for_each_stream_option([&](const auto& row) {
    read_value(row, std::string(row.key), keywords, row.kOption(options));
  });
  options.access = access(keywords, options.trust);
  return options;
}

std::vector<std::string> access_keywords() { return {"mode", "group", "owner"}; }

std::vector<std::string> producer_keywords() {
  std::vector<std::string> all = access_keywords();
  all.insert(all.end(), {"names", "units", "dimensions", "kinds", "clock", "law", "start"});
  ipc::for_each_stream_option([&](const auto& row) { all.emplace_back(row.key); });
  return all;
}

std::vector<std::string> solver_keywords() {
  std::vector<std::string> all = access_keywords();
  all.insert(all.end(), {"method", "limits", "named_limits", "wake"});
  ipc::for_each_option([&](const auto& row) { all.emplace_back(python_key(row.key)); });
  return all;
}

SolverOptions solver_options(const py::kwargs& keywords) {
  SolverOptions options;
  with(keywords, "method",
       [&](const py::object& v) { options.method = &method(as<std::string>(v, "method")); });
  with(keywords, "wake", [&](const py::object& v) { options.wake = as<bool>(v, "wake"); });
  ipc::for_each_option([&](const auto& row) {
    read_value(row, std::string(python_key(row.key)), keywords, options.*row.kOption);
  });
  read_limits(keywords, options);
  options.access = access(keywords, options.trust);
  return options;
}

}  // namespace splinecast::python
