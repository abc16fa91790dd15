#include "ipc/python/values/arrays.hpp"

#include <cstring>
#include <string>

#include "splinecast/errors.hpp"

namespace splinecast::python {
namespace {

using Api = py::detail::npy_api;

constexpr py::ssize_t kSize = sizeof(double);

bool is_native_double(const py::array& array) {
  const auto* const proxy = py::detail::array_proxy(array.ptr());
  const auto* const type = py::detail::array_descriptor_proxy(proxy->descr);
  return type->type_num == Api::NPY_DOUBLE_ && type->byteorder != '>' &&
         (proxy->flags & Api::NPY_ARRAY_ALIGNED_) != 0;
}

std::string shape_text(const py::array& array) {
  return std::string(py::repr(array.attr("shape")));
}

double value_at(const void* data, py::ssize_t offset) {
  double value = 0;
  std::memcpy(&value, static_cast<const char*>(data) + offset, sizeof(value));
  return value;
}

py::array converted(const py::array& array, int flags) {
  PyObject* const made = Api::get().PyArray_FromAny_(
      array.ptr(), py::dtype::of<double>().release().ptr(), 0, 0,
      flags | Api::NPY_ARRAY_ALIGNED_ | Api::NPY_ARRAY_FORCECAST_, nullptr);
  if (made == nullptr) throw py::error_already_set();
  return py::reinterpret_steal<py::array>(made);
}

[[noreturn]] void refuse_count(const char* what, std::size_t count) {
  throw BadRequest(std::string(what) + " has " + std::to_string(count) +
                   " values; a stream has at most " + std::to_string(kMaxDimensions) +
                   " dimensions");
}

}  // namespace

py::array doubles(py::handle values, const char* what) {
  py::array array;
  if (py::isinstance<py::array>(values)) {
    array = py::reinterpret_borrow<py::array>(values);
  } else {
    PyObject* const made = Api::get().PyArray_FromAny_(values.ptr(), nullptr, 0, 0, 0, nullptr);
    if (made == nullptr) throw py::error_already_set();
    array = py::reinterpret_steal<py::array>(made);
  }
  if (is_native_double(array)) return array;
  const char kind = array.dtype().kind();
  if (kind != 'f' && kind != 'i' && kind != 'u' && array.size() > 0) {
    throw py::type_error(std::string(what) + " must be real numbers, not " +
                         std::string(py::repr(array.dtype())));
  }
  return converted(array, 0);
}

py::array contiguous_doubles(py::handle values, const char* what) {
  const py::array array = doubles(values, what);
  return (array.flags() & py::array::c_style) != 0 ? array
                                                   : converted(array, Api::NPY_ARRAY_C_CONTIGUOUS_);
}

py::array_t<double> to_array(std::span<const double> values) {
  return py::array_t<double>(static_cast<py::ssize_t>(values.size()), values.data());
}

std::span<double> memory_of(py::array& array) {
  return {static_cast<double*>(array.mutable_data()), static_cast<std::size_t>(array.size())};
}

// NOLINTNEXTLINE(*-member-init): only values_ is read
Row::Row(py::handle values, const char* what) {
  if (!values.is_none()) read(values, what);
}

void Row::read(py::handle values, const char* what) {
  const bool is_list = PyList_Check(values.ptr()) || PyTuple_Check(values.ptr());
  if (PyFloat_Check(values.ptr())) {
    copy_[0] = PyFloat_AS_DOUBLE(values.ptr());
    values_ = std::span(copy_).first(1);
  } else if (!is_list || !read_list(values)) {
    read_array(doubles(values, what), what);
  }
}

/// Reads a list of Python numbers. Returns false for one with other items.
bool Row::read_list(py::handle values) {
  const auto size = static_cast<std::size_t>(PySequence_Fast_GET_SIZE(values.ptr()));
  if (size > copy_.size()) return false;
  PyObject* const* const items = PySequence_Fast_ITEMS(values.ptr());
  for (std::size_t i = 0; i < size; ++i) {
    if (PyFloat_Check(items[i])) {
      copy_[i] = PyFloat_AS_DOUBLE(items[i]);
    } else if (PyLong_Check(items[i]) && !PyBool_Check(items[i])) {
      copy_[i] = PyLong_AsDouble(items[i]);
      if (copy_[i] == -1 && PyErr_Occurred() != nullptr) throw py::error_already_set();
    } else {
      return false;
    }
  }
  values_ = std::span(copy_).first(size);
  return true;
}

void Row::read_array(const py::array& array, const char* what) {
  if (array.ndim() > 1) {
    throw BadRequest(std::string(what) + " must have one value per dimension, not shape " +
                     shape_text(array));
  }
  const auto size = static_cast<std::size_t>(array.size());
  const py::ssize_t stride = array.ndim() == 1 ? array.strides(0) : kSize;
  if (size > copy_.size()) refuse_count(what, size);
  if (stride == kSize || size == 1) {
    values_ = {static_cast<const double*>(array.data()), size};
    held_ = array;
    return;
  }
  for (std::size_t i = 0; i < size; ++i) {
    copy_[i] = value_at(array.data(), static_cast<py::ssize_t>(i) * stride);
  }
  values_ = std::span(copy_).first(size);
}

Rows::Rows(py::handle values, const char* what) : what_(what) {
  if (values.is_none()) return;
  array_ = doubles(values, what);
  if (array_.ndim() != 1 && array_.ndim() != 2) {
    throw BadRequest(std::string(what) + " must have shape (n, D) or (n,), not " +
                     shape_text(array_));
  }
  is_line_ = array_.ndim() == 1;
  rows_ = static_cast<std::size_t>(array_.shape(0));
  row_stride_ = array_.strides(0);
  dimensions_ = is_line_ ? 1 : static_cast<std::size_t>(array_.shape(1));
  stride_ = is_line_ ? kSize : array_.strides(1);
  if (dimensions_ > kMaxDimensions) refuse_count(what, dimensions_);
}

std::span<const double> Rows::row(std::size_t i, std::span<double> scratch) const {
  const char* const begin =
      static_cast<const char*>(array_.data()) + static_cast<py::ssize_t>(i) * row_stride_;
  if (stride_ == kSize || dimensions_ == 1) {
    return {static_cast<const double*>(static_cast<const void*>(begin)), dimensions_};
  }
  for (std::size_t d = 0; d < dimensions_; ++d) {
    scratch[d] = value_at(begin, static_cast<py::ssize_t>(d) * stride_);
  }
  return scratch.first(dimensions_);
}

std::span<const double> Rows::all() {
  if (rows_ == 0) return {};
  array_ = contiguous_doubles(array_, what_);
  return {static_cast<const double*>(array_.data()), rows_ * dimensions_};
}

void Rows::require(std::size_t n, std::size_t dimensions, bool is_optional) const {
  if (is_optional && rows_ == 0) return;
  if (rows_ == n && dimensions_ == dimensions) return;
  throw BadRequest(std::string(what_) + " has " + std::to_string(rows_) + " rows of " +
                   std::to_string(dimensions_) + " values, not " + std::to_string(n) + " of " +
                   std::to_string(dimensions));
}

}  // namespace splinecast::python
