#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "splinecast.h"
#include "splinecast/state.hpp"
#include "splinecast/time.hpp"
#include "splinecast/waypoint.hpp"

/// Checks of the pointers and arrays that a C program passes, and views of their values. Each
/// function throws BadArgument, which names the argument and its value.
namespace splinecast::ipc {

/// Longest text that an argument may have.
inline constexpr std::size_t kMaxText = 4095;

[[noreturn]] void refuse(std::string_view name, const std::string& problem);

void require_pointer(const void* pointer, std::size_t alignment, std::string_view name);

/// Returns the pointer if it is not null and aligned to its type.
template <typename T>
T* require_pointer(T* pointer, std::string_view name) {
  require_pointer(pointer, alignof(T), name);
  return pointer;
}

/// Requires `count` objects at `pointer`; with none, the pointer may be null.
template <typename T>
std::span<T> require_objects(T* pointer, std::size_t count, std::string_view name) {
  if (count == 0 && pointer == nullptr) return {};
  require_pointer(pointer, name);
  if (count > static_cast<std::size_t>(PTRDIFF_MAX) / sizeof(T)) {
    refuse(name, "has " + std::to_string(count) + " elements, more than memory can hold");
  }
  return {pointer, count};
}

/// A text that ends with a zero byte.
[[nodiscard]] std::string_view require_text(const char* text, std::string_view name);

/// A number of a C enum: 0 ≤ value < count.
[[nodiscard]] int require_choice(int value, int count, std::string_view name);

/// A truth value: 0 or 1.
[[nodiscard]] bool require_flag(int value, std::string_view name);

/// A time-out: 0 for a negative one, so that the end of the wait is a time.
[[nodiscard]] inline Time timeout_of(std::int64_t timeout) noexcept {
  return std::max(Time(timeout), Time::zero());
}

/// Elements of one array with a stride: checked, so that no address of an element overflows.
template <typename T>
class Strided {
 public:
  Strided() = default;
  /// `data` may be null only if `count` is 0. A stride of 0 becomes 1.
  Strided(T* data, std::size_t count, std::ptrdiff_t stride, std::string_view name);

  [[nodiscard]] std::size_t size() const noexcept { return count_; }
  [[nodiscard]] bool given() const noexcept { return data_ != nullptr; }
  [[nodiscard]] bool is_contiguous() const noexcept { return stride_ == 1 || count_ < 2; }
  [[nodiscard]] T& operator[](std::size_t i) const noexcept {
    return data_[static_cast<std::ptrdiff_t>(i) * stride_];
  }
  /// Its elements as a span; contiguous only.
  [[nodiscard]] std::span<T> span() const noexcept { return {data_, count_}; }

 private:
  T* data_ = nullptr;
  std::size_t count_ = 0;
  std::ptrdiff_t stride_ = 1;
};

using Values = Strided<const double>;
using Outputs = Strided<double>;
using Stamps = Strided<const std::int64_t>;

/// A vector with one value per dimension.
[[nodiscard]] Values require_vector(const splinecast_vector& vector, std::size_t dimensions,
                                    std::string_view name);
/// The same, or one that is not given.
[[nodiscard]] Values optional_vector(const splinecast_vector& vector, std::size_t dimensions,
                                     std::string_view name);
[[nodiscard]] Outputs require_output(const splinecast_output& output, std::size_t dimensions,
                                     std::string_view name);
[[nodiscard]] Outputs optional_output(const splinecast_output& output, std::size_t dimensions,
                                      std::string_view name);
[[nodiscard]] Stamps require_times(const splinecast_times& times, std::string_view name);

/// A checked matrix.
template <typename T>
class Rows {
 public:
  Rows() = default;
  /// `data` may be null only if `rows` is 0. Requires `columns`.
  Rows(T* data, std::size_t rows, std::size_t columns, std::ptrdiff_t row_stride,
       std::ptrdiff_t column_stride, std::string_view name);

  [[nodiscard]] std::size_t size() const noexcept { return first_column_.size(); }
  [[nodiscard]] bool given() const noexcept { return first_column_.given(); }
  /// Whether each row is contiguous.
  [[nodiscard]] bool has_contiguous_rows() const noexcept {
    return column_stride_ == 1 || columns_ < 2;
  }
  /// Whether all values are contiguous, row after row.
  [[nodiscard]] bool is_contiguous() const noexcept {
    return has_contiguous_rows() &&
           (size() < 2 || row_stride_ == static_cast<std::ptrdiff_t>(columns_));
  }
  [[nodiscard]] T& at(std::size_t row, std::size_t column) const noexcept {
    return *(&first_column_[row] + static_cast<std::ptrdiff_t>(column) * column_stride_);
  }
  /// A row as a span; contiguous rows only.
  [[nodiscard]] std::span<T> row(std::size_t i) const noexcept { return {&at(i, 0), columns_}; }
  /// All values as a span; contiguous only.
  [[nodiscard]] std::span<T> span() const noexcept {
    return size() == 0 ? std::span<T>() : std::span<T>(&at(0, 0), size() * columns_);
  }

 private:
  Strided<T> first_column_;
  std::size_t columns_ = 0;
  std::ptrdiff_t row_stride_ = 0;
  std::ptrdiff_t column_stride_ = 1;
};

/// A message for a C program: writes it to `text`, cut, and returns its full length.
int put_text(std::string_view message, char* text, std::size_t capacity);

}  // namespace splinecast::ipc
