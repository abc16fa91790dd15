#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <cstdint>
#include <optional>
#include <vector>

#include "ipc/python/values/times.hpp"
#include "splinecast/method.hpp"
#include "splinecast/piecewise_polynomial.hpp"

namespace splinecast::python {

namespace py = pybind11;

/// The times of a curve whose times were given as floats. The polynomial's times are integers, so
/// such a curve is computed in *ticks* of 2^−k ns after the first time, with the largest k for
/// which all ticks are below 2⁶¹: this rounds a time by at most 2⁻⁶² of the range. As the
/// polynomial takes ticks for nanoseconds, its time is stretched by 2^k. That is a power of two, so
/// the r-th derivative of the true curve is 2^(k·r) times that of the polynomial, without rounding.
/// A curve of times in ns has ticks of 1 ns.
class TimeScale {
 public:
  TimeScale() = default;
  /// For increasing, finite times; at least one.
  explicit TimeScale(std::span<const double> seconds);

  [[nodiscard]] bool is_seconds() const { return is_seconds_; }
  /// A time in ticks; not rounded if the ticks are ns.
  [[nodiscard]] long double ticks_of_seconds(double seconds) const;
  [[nodiscard]] long double ticks_of(Time time) const;
  /// A tick in seconds.
  [[nodiscard]] double seconds_of(Time tick) const;
  /// value · 2^(k·power), exact unless it underflows or overflows. Power 1 makes velocities of the
  /// polynomial true ones, −1 makes true velocities those of the polynomial.
  [[nodiscard]] double scaled(double value, int power) const;

 private:
  bool is_seconds_ = false;
  long double origin_ = 0;
  int exponent_ = 0;
  long double per_second_ = 1e9L;  ///< ticks
};

/// The facts of a fit that the polynomial does not have.
struct FitFacts {
  bool is_line = false;  ///< positions were of shape (n,)
  const Method* method = nullptr;
  std::optional<double> lambda{};
  std::vector<double> seconds{};  ///< the times as given, if they were floats
};

/// The Python class Curve.
class Curve {
 public:
  Curve(PiecewisePolynomial polynomial, TimeScale scale, FitFacts facts);

  [[nodiscard]] py::object evaluate(py::handle times, int derivative, bool extrapolate) const;
  [[nodiscard]] py::object to_ppoly(py::handle origin) const;
  [[nodiscard]] py::array breaks() const;
  [[nodiscard]] std::size_t dimensions() const { return polynomial_.dimensions(); }
  [[nodiscard]] std::size_t segments() const { return polynomial_.segments(); }
  [[nodiscard]] const FitFacts& facts() const { return facts_; }

 private:
  void evaluate_all(const Instants& times, int derivative, bool extrapolate,
                    std::span<double> out) const;
  [[nodiscard]] std::size_t segment_at(long double tick, std::size_t guess) const;
  [[nodiscard]] py::array coefficients() const;
  [[nodiscard]] py::array seconds_after(py::handle origin) const;
  [[noreturn]] void refuse(const Instants& times, std::size_t i) const;

  PiecewisePolynomial polynomial_;
  TimeScale scale_;
  FitFacts facts_;
};

}  // namespace splinecast::python
