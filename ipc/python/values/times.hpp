#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <optional>
#include <span>
#include <vector>

#include "splinecast/time.hpp"

/// Instants and durations. An instant is an int, nanoseconds, or a float, seconds; a duration is a
/// number of seconds. Functions throw TypeError for other types, bool, float16 and float32
/// included, and BadRequest with the value for NaN and for values out of range.
namespace splinecast::python {

namespace py = pybind11;

/// An instant, rounded to the nanosecond, within ±2⁶² ns.
[[nodiscard]] Time instant(py::handle value);

/// The same; Time::min() for None: as soon as possible.
[[nodiscard]] Time instant_or_soonest(py::handle value);

/// Seconds after 0 that an instant may have: ±2⁶² ns.
[[nodiscard]] Time instant_of_seconds(double seconds);

/// A duration, at least 0; `what` is its name in messages. Rounded to the nanosecond, and up to
/// 1 ns if it is positive; at most Time::max().
[[nodiscard]] Time duration(py::handle value, const char* what);

/// The same; nothing for None.
[[nodiscard]] std::optional<Time> optional_duration(py::handle value, const char* what);

/// Throws BadRequest if a time is more than an hour from that of CLOCK_MONOTONIC, with both and the
/// clock that it may be of.
void require_near_now(Time time);

/// Nanoseconds, or None for the least or the largest time.
[[nodiscard]] py::object optional_ns(Time time);

/// Instants of any shape as a contiguous array of int64 (ns) or of float64 (s), which is the given
/// array if it already is one. A list must not mix ints and floats, because their units differ.
class Instants {
 public:
  explicit Instants(py::handle values);

  [[nodiscard]] std::size_t size() const { return static_cast<std::size_t>(array_.size()); }
  [[nodiscard]] const py::array& array() const { return array_; }
  /// Whether they are floats of seconds.
  [[nodiscard]] bool is_seconds() const { return is_seconds_; }
  [[nodiscard]] std::span<const double> seconds() const;

  /// All as nanoseconds: the array's memory, or that of `scratch`.
  [[nodiscard]] std::span<const Time> times(std::vector<Time>& scratch) const;

  /// Throws BadRequest unless they are one-dimensional.
  void require_line() const;

 private:
  py::array array_;
  bool is_seconds_;
};

}  // namespace splinecast::python
