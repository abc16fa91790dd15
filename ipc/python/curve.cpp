#include "ipc/python/curve.hpp"

#include <pybind11/stl.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/basics/number_text.hpp"
#include "core/polynomial/segment.hpp"
#include "ipc/python/docstrings.hpp"
#include "ipc/python/held.hpp"
#include "ipc/python/module.hpp"
#include "ipc/python/values/arrays.hpp"
#include "splinecast/errors.hpp"
#include "splinecast/waypoint.hpp"

namespace splinecast::python {
namespace {

constexpr long double kNsPerSecond = 1e9L;
/// All ticks are below 2 to this power.
constexpr int kTickBits = 61;
/// From this number of times on, an evaluation releases the GIL.
constexpr std::size_t kManyTimes = 64;

constexpr long double to_real(double value) { return static_cast<long double>(value); }
long double to_real(Time time) { return static_cast<long double>(time.count()); }

}  // namespace

TimeScale::TimeScale(std::span<const double> seconds)
    : is_seconds_(true), origin_(to_real(seconds.front())) {
  const long double range = to_real(seconds.back()) - origin_;
  if (range == 0) return;
  int bits = 0;
  (void)std::frexp(range * kNsPerSecond, &bits);
  exponent_ = kTickBits - bits;
  per_second_ = std::ldexp(kNsPerSecond, exponent_);
}

long double TimeScale::ticks_of_seconds(double seconds) const {
  if (is_seconds_) {
    const long double after = to_real(seconds) - origin_;
    return std::nearbyint(after * per_second_);
  }
  // A float next to a whole number of ns means that number.
  const long double ns = to_real(seconds) * kNsPerSecond;
  const long double whole = std::nearbyint(ns);
  const long double rounding = std::abs(ns) * to_real(std::numeric_limits<double>::epsilon() / 2);
  return std::abs(ns - whole) <= rounding ? whole : ns;
}

long double TimeScale::ticks_of(Time time) const {
  if (!is_seconds_) return to_real(time);
  const long double after = to_real(time) / kNsPerSecond - origin_;
  return std::nearbyint(after * per_second_);
}

double TimeScale::seconds_of(Time tick) const {
  return static_cast<double>(origin_ + to_real(tick) / per_second_);
}

double TimeScale::scaled(double value, int power) const {
  return std::ldexp(value, exponent_ * power);
}

Curve::Curve(PiecewisePolynomial polynomial, TimeScale scale, FitFacts facts)
    : polynomial_(std::move(polynomial)), scale_(scale), facts_(std::move(facts)) {}

void Curve::refuse(const Instants& times, std::size_t i) const {
  const auto text = [&](Time tick) {
    return scale_.is_seconds() ? core::number_text(scale_.seconds_of(tick))
                               : std::to_string(tick.count());
  };
  const auto breaks = polynomial_.breaks();
  const auto* const ns = static_cast<const std::int64_t*>(times.array().data());
  const std::string time = times.is_seconds() ? core::number_text(times.seconds()[i]) + " s"
                                              : std::to_string(ns[i]) + " ns";
  throw BadRequest("time " + time + " (index " + std::to_string(i) + ") is not within " +
                   text(breaks.front()) + " to " + text(breaks.back()) +
                   (scale_.is_seconds() ? " s" : " ns") + ", where the curve is");
}

/// The segment of a tick. Tries the guess first.
std::size_t Curve::segment_at(long double tick, std::size_t guess) const {
  const bool is_last = guess + 1 == polynomial_.segments();
  if (tick >= to_real(polynomial_.left_of(guess)) &&
      (is_last || tick < to_real(polynomial_.right_of(guess)))) {
    return guess;
  }
  const long double most = to_real(kLatestTime);
  return polynomial_.segment_at(
      Time(static_cast<std::int64_t>(std::floor(std::clamp(tick, -most, most)))));
}

void Curve::evaluate_all(const Instants& times, int derivative, bool extrapolate,
                         std::span<double> out) const {
  const long double first = to_real(polynomial_.breaks().front());
  const long double last = to_real(polynomial_.breaks().back());
  const auto* const ns = static_cast<const std::int64_t*>(times.array().data());
  const double factor = scale_.scaled(1, derivative);
  std::size_t segment = 0;
  for (std::size_t i = 0; i < times.size(); ++i) {
    const long double tick = times.is_seconds() ? scale_.ticks_of_seconds(times.seconds()[i])
                                                : scale_.ticks_of(Time(ns[i]));
    const bool is_inside = tick >= first && tick <= last;
    if (!is_inside && (!extrapolate || !std::isfinite(tick))) refuse(times, i);
    segment = segment_at(tick, segment);
    const auto u =
        static_cast<double>((tick - to_real(polynomial_.left_of(segment))) / kNsPerSecond);
    const auto row = out.subspan(i * dimensions(), dimensions());
    core::evaluate_derivative(polynomial_.order_of(segment), polynomial_.coefficients(segment), u,
                              derivative, row);
    for (double& value : row) value *= factor;
  }
}

py::object Curve::evaluate(py::handle times, int derivative, bool extrapolate) const {
  if (derivative < 0) {
    throw BadRequest("nu must be 0 or more, not " + std::to_string(derivative));
  }
  const Instants instants(times);
  std::vector<py::ssize_t> shape(instants.array().shape(),
                                 instants.array().shape() + instants.array().ndim());
  if (!facts_.is_line) shape.push_back(static_cast<py::ssize_t>(dimensions()));
  py::array out(py::dtype::of<double>(), shape);
  const std::span<double> memory = memory_of(out);
  const auto run = [&] { evaluate_all(instants, derivative, extrapolate, memory); };
  if (instants.size() < kManyTimes) {
    run();
  } else {
    without_gil(run);
  }
  if (shape.empty()) return py::float_(memory[0]);
  return out;
}

py::array Curve::breaks() const {
  const auto ticks = polynomial_.breaks();
  if (scale_.is_seconds()) return to_array(facts_.seconds);
  py::array_t<std::int64_t> ns(static_cast<py::ssize_t>(ticks.size()));
  std::ranges::transform(ticks, ns.mutable_data(), [](Time tick) { return tick.count(); });
  return ns;
}

/// [order][segment][dimension], highest power first, padded with zeros.
py::array Curve::coefficients() const {
  const auto order = static_cast<std::size_t>(polynomial_.order());
  const std::size_t row = segments() * dimensions();
  py::array c(py::dtype::of<double>(), {order, segments(), dimensions()});
  const std::span<double> memory = memory_of(c);
  std::ranges::fill(memory, 0.0);
  for (std::size_t i = 0; i < segments(); ++i) {
    const auto powers = static_cast<std::size_t>(polynomial_.order_of(i));
    for (std::size_t j = 0; j < powers * dimensions(); ++j) {
      const std::size_t power = j / dimensions();
      memory[(order - 1 - power) * row + i * dimensions() + j % dimensions()] =
          scale_.scaled(polynomial_.coefficients(i)[j], static_cast<int>(power));
    }
  }
  if (!facts_.is_line) return c;
  return c.attr("reshape")(order, segments());
}

py::array Curve::seconds_after(py::handle origin) const {
  if (!scale_.is_seconds()) {
    const Time zero = instant(origin);
    std::vector<double> seconds;
    for (const Time tick : polynomial_.breaks()) seconds.push_back(to_seconds(tick - zero));
    return to_array(seconds);
  }
  const double zero =
      PyFloat_Check(origin.ptr()) ? PyFloat_AS_DOUBLE(origin.ptr()) : to_seconds(instant(origin));
  std::vector<double> seconds = facts_.seconds;
  for (double& second : seconds) second -= zero;
  return to_array(seconds);
}

py::object Curve::to_ppoly(py::handle origin) const {
  if (polynomial_.is_hold()) {
    throw BadRequest("the curve is the hold of a single waypoint, which has no interval");
  }
  return py::module_::import("scipy.interpolate")
      .attr("PPoly")(coefficients(), seconds_after(origin));
}

void define_curve(py::module_& module) {
  py::class_<Curve>(module, "Curve", doc::Curve)
      .def("__call__", &Curve::evaluate, py::arg("t"), py::arg("nu") = 0,
           py::arg("extrapolate") = false, doc::Curve_call)
      .def("to_ppoly", &Curve::to_ppoly, py::arg("origin") = 0, doc::Curve_to_ppoly)
      .def_property_readonly("breaks", &Curve::breaks, doc::Curve_breaks)
      .def_property_readonly("dimensions", &Curve::dimensions, doc::Curve_dimensions)
      .def_property_readonly(
          "method",
          [](const Curve& self) -> std::optional<std::string> {
            if (self.facts().method == nullptr) return std::nullopt;
            return std::string(self.facts().method->name);
          },
          doc::Curve_method)
      .def_property_readonly(
          "lam", [](const Curve& self) { return self.facts().lambda; }, doc::Curve_lam)
      .def("__len__", &Curve::segments, doc::Curve_len)
      .def("__repr__", [](const Curve& self) {
        return "<splinecast.Curve of " + std::to_string(self.segments()) + " segments and " +
               std::to_string(self.dimensions()) + " dimensions>";
      });
}

}  // namespace splinecast::python
