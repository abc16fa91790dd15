#include "ipc/arguments/arrays.hpp"

#include <algorithm>
#include <climits>
#include <cstring>

#include "ipc/arguments/guard.hpp"

namespace splinecast::ipc {
namespace {

/// The bytes from the first element to the last one, with their sign.
std::ptrdiff_t require_extent(std::size_t count, std::ptrdiff_t stride, std::size_t element,
                              std::string_view name) {
  std::ptrdiff_t extent = 0;
  const std::size_t steps = count == 0 ? 0 : count - 1;
  if (__builtin_mul_overflow(steps, stride, &extent) ||
      __builtin_mul_overflow(extent, static_cast<std::ptrdiff_t>(element), &extent)) {
    refuse(name, std::to_string(count) + " elements with a stride of " + std::to_string(stride) +
                     " are more than memory can hold");
  }
  return extent;
}

/// Requires that the elements before and after `data` are at addresses that a program can have: the
/// upper half is the kernel's.
void require_addresses(const void* data, std::ptrdiff_t least, std::ptrdiff_t most,
                       std::string_view name) {
  const auto address = reinterpret_cast<std::intptr_t>(data);
  std::intptr_t first = 0;
  std::intptr_t last = 0;
  if (__builtin_add_overflow(address, least, &first) ||
      __builtin_add_overflow(address, most, &last) || first <= 0) {
    refuse(name, "has elements outside of the address space");
  }
}

std::string counted(std::size_t count, std::size_t dimensions) {
  return "has " + std::to_string(count) + " values, not " + std::to_string(dimensions);
}

}  // namespace

void refuse(std::string_view name, const std::string& problem) {
  throw BadArgument(std::string(name) + " " + problem);
}

void require_pointer(const void* pointer, std::size_t alignment, std::string_view name) {
  if (pointer == nullptr) refuse(name, "is NULL");
  if (reinterpret_cast<std::uintptr_t>(pointer) % alignment != 0) {
    refuse(name, "is not aligned to " + std::to_string(alignment) + " bytes");
  }
}

std::string_view require_text(const char* text, std::string_view name) {
  require_pointer(text, name);
  const std::size_t length = strnlen(text, kMaxText + 1);
  if (length > kMaxText) {
    refuse(name, "has more than " + std::to_string(kMaxText) + " bytes");
  }
  return {text, length};
}

int require_choice(int value, int count, std::string_view name) {
  if (value < 0 || value >= count) {
    refuse(name, "is " + std::to_string(value) + ", not 0 to " + std::to_string(count - 1));
  }
  return value;
}

bool require_flag(int value, std::string_view name) { return require_choice(value, 2, name) == 1; }

template <typename T>
Strided<T>::Strided(T* data, std::size_t count, std::ptrdiff_t stride, std::string_view name)
    : data_(data), count_(count), stride_(stride == 0 ? 1 : stride) {
  if (data == nullptr && count == 0) return;
  require_pointer(data, name);
  const std::ptrdiff_t extent = require_extent(count, stride_, sizeof(T), name);
  require_addresses(data, std::min<std::ptrdiff_t>(extent, 0), std::max<std::ptrdiff_t>(extent, 0),
                    name);
}
template class Strided<const double>;
template class Strided<double>;
template class Strided<const std::int64_t>;

Values optional_vector(const splinecast_vector& vector, std::size_t dimensions,
                       std::string_view name) {
  const Values values(vector.data, vector.count, vector.stride, name);
  if (values.given() && values.size() != dimensions)
    refuse(name, counted(values.size(), dimensions));
  return values;
}

Values require_vector(const splinecast_vector& vector, std::size_t dimensions,
                      std::string_view name) {
  require_pointer(vector.data, name);
  return optional_vector(vector, dimensions, name);
}

Outputs optional_output(const splinecast_output& output, std::size_t dimensions,
                        std::string_view name) {
  const Outputs values(output.data, output.count, output.stride, name);
  if (values.given() && values.size() != dimensions)
    refuse(name, counted(values.size(), dimensions));
  return values;
}

Outputs require_output(const splinecast_output& output, std::size_t dimensions,
                       std::string_view name) {
  require_pointer(output.data, name);
  return optional_output(output, dimensions, name);
}

Stamps require_times(const splinecast_times& times, std::string_view name) {
  return {times.data, times.count, times.stride, name};
}

template <typename T>
Rows<T>::Rows(T* data, std::size_t rows, std::size_t columns, std::ptrdiff_t row_stride,
              std::ptrdiff_t column_stride, std::string_view name)
    : columns_(columns), row_stride_(row_stride), column_stride_(column_stride) {
  if (data == nullptr && rows == 0) return;
  require_pointer(data, name);
  if (column_stride_ == 0) column_stride_ = 1;
  const std::ptrdiff_t across = require_extent(columns, column_stride_, sizeof(T), name);
  std::ptrdiff_t wide = 0;
  if (__builtin_mul_overflow(columns, column_stride_, &wide)) refuse(name, "has too many columns");
  if (row_stride_ == 0) row_stride_ = wide;
  first_column_ = Strided<T>(data, rows, row_stride_, name);
  const std::ptrdiff_t down = require_extent(rows, row_stride_, sizeof(T), name);
  std::ptrdiff_t corner = 0;
  if (__builtin_add_overflow(down, across, &corner)) refuse(name, "is larger than memory can be");
  require_addresses(data, std::min({down, across, corner, std::ptrdiff_t{0}}),
                    std::max({down, across, corner, std::ptrdiff_t{0}}), name);
}
template class Rows<const double>;
template class Rows<double>;

int put_text(std::string_view message, char* text, std::size_t capacity) {
  if (capacity > 0 || text != nullptr) require_pointer(text, "text");
  if (capacity > 0) {
    const std::size_t length = std::min(message.size(), capacity - 1);
    std::copy_n(message.begin(), length, text);
    text[length] = '\0';
  }
  return static_cast<int>(std::min<std::size_t>(message.size(), INT_MAX));
}

}  // namespace splinecast::ipc
