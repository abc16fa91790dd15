#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <array>
#include <span>

#include "splinecast/state.hpp"

/// Values in arrays, lists and numbers. float64 is read where it is; other real numbers are
/// converted. Functions throw TypeError for other types, and BadRequest for a wrong shape.
namespace splinecast::python {

namespace py = pybind11;

/// One value per dimension: an array-like of shape (n,), or a number. Empty for None.
class Row {
 public:
  /// `what` is the name in messages.
  Row(py::handle values, const char* what);
  Row(const Row&) = delete;
  Row& operator=(const Row&) = delete;

  /// Valid while this object lives.
  [[nodiscard]] std::span<const double> values() const noexcept { return values_; }

 private:
  void read(py::handle values, const char* what);
  bool read_list(py::handle values);
  void read_array(const py::array& array, const char* what);

  py::object held_;
  std::array<double, kMaxDimensions> copy_;  // not initialised: only values_ is read
  std::span<const double> values_;
};

/// Rows of shape (n, D), or (n,) for D = 1. Empty for None.
class Rows {
 public:
  Rows(py::handle values, const char* what);

  [[nodiscard]] bool empty() const { return rows_ == 0; }
  [[nodiscard]] std::size_t size() const { return rows_; }
  [[nodiscard]] std::size_t dimensions() const { return dimensions_; }
  /// Whether the shape was (n,).
  [[nodiscard]] bool is_line() const { return is_line_; }

  /// Row i; `scratch` has its values if they are not contiguous.
  [[nodiscard]] std::span<const double> row(std::size_t i, std::span<double> scratch) const;

  /// All rows as contiguous memory: copied if they are not.
  [[nodiscard]] std::span<const double> all();

  /// Throws BadRequest, naming both shapes, unless there are n rows, or none and `is_optional`.
  void require(std::size_t n, std::size_t dimensions, bool is_optional) const;

 private:
  const char* what_;
  py::array array_;
  std::size_t rows_ = 0;
  std::size_t dimensions_ = 0;
  py::ssize_t row_stride_ = 0;
  py::ssize_t stride_ = 0;
  bool is_line_ = false;
};

/// Any array-like of real numbers as an array of aligned float64: itself if it is one.
[[nodiscard]] py::array doubles(py::handle values, const char* what);

/// The same, contiguous.
[[nodiscard]] py::array contiguous_doubles(py::handle values, const char* what);

/// An array of float64 with a copy of the values.
[[nodiscard]] py::array_t<double> to_array(std::span<const double> values);

/// The memory of an array of float64 that this module made.
[[nodiscard]] std::span<double> memory_of(py::array& array);

}  // namespace splinecast::python
