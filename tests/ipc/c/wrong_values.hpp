#pragma once

#include <gtest/gtest.h>

#include <cstddef>
#include <functional>
#include <limits>
#include <string>
#include <type_traits>

#include "splinecast.h"

namespace splinecast::testing {

inline constexpr ptrdiff_t kFar = std::numeric_limits<ptrdiff_t>::max();

/// Requires that a call is an error whose message begins with the name of the argument.
inline void expect_refused(const std::string& argument, const std::string& what, int result) {
  EXPECT_EQ(result, SPLINECAST_ERROR_ARGUMENT) << argument << " " << what;
  EXPECT_EQ(std::string(splinecast_last_error()).find(argument), 0U)
      << argument << " " << what << ": " << splinecast_last_error();
}

template <typename T>
T* misaligned(T* pointer) {
  using Byte = std::conditional_t<std::is_const_v<T>, const std::byte, std::byte>;
  return reinterpret_cast<T*>(reinterpret_cast<Byte*>(pointer) + 1);
}

/// Each wrong form of a vector, an output or times, which the call uses.
template <typename Vector>
void try_vector(const std::string& name, Vector& vector, const std::function<int()>& call) {
  const Vector valid = vector;
  ASSERT_GT(valid.count, 0U) << name;
  const auto with = [&](const char* what, const Vector& wrong) {
    vector = wrong;
    expect_refused(name, what, call());
    vector = valid;
  };
  with("null", {nullptr, valid.count, 1});
  with("misaligned", {misaligned(valid.data), valid.count, 1});
  with("short", {valid.data, valid.count - 1, 1});
  with("empty", {valid.data, 0, 1});
  with("long", {valid.data, valid.count + 1, 1});
  with("endless", {valid.data, std::numeric_limits<size_t>::max(), 1});
  with("overflowing count", {valid.data, std::numeric_limits<size_t>::max() / 8 + 2, 1});
  if (valid.count < 2) return;
  with("far", {valid.data, valid.count, kFar});
  with("far back", {valid.data, valid.count, std::numeric_limits<ptrdiff_t>::min()});
  with("beyond the address space", {valid.data, valid.count, kFar / 8});
  with("before the address space", {valid.data, valid.count, -(kFar / 8)});
}

template <typename Matrix>
void try_matrix(const std::string& name, Matrix& matrix, const std::function<int()>& call) {
  const Matrix valid = matrix;
  const auto with = [&](const char* what, const Matrix& wrong) {
    matrix = wrong;
    expect_refused(name, what, call());
    matrix = valid;
  };
  const auto [data, rows, columns, row_stride, column_stride] = valid;
  with("null", {nullptr, rows, columns, 0, 0});
  with("misaligned", {misaligned(data), rows, columns, 0, 0});
  with("few rows", {data, rows - 1, columns, 0, 0});
  with("many rows", {data, rows + 1, columns, 0, 0});
  with("few columns", {data, rows, columns - 1, 0, 0});
  with("many columns", {data, rows, columns + 1, 0, 0});
  with("no columns", {data, rows, 0, 0, 0});
  with("endless rows", {data, std::numeric_limits<size_t>::max(), columns, 0, 0});
  with("endless columns", {data, rows, std::numeric_limits<size_t>::max(), 0, 0});
  with("far rows", {data, rows, columns, kFar, 0});
  with("far back rows", {data, rows, columns, std::numeric_limits<ptrdiff_t>::min(), 0});
  with("rows beyond the address space", {data, rows, columns, kFar / 8, 0});
  with("far columns", {data, rows, columns, 0, kFar});
  with("columns before the address space", {data, rows, columns, 1, -(kFar / 8)});
  with("corner beyond the address space", {data, rows, columns, kFar / 16, kFar / 16});
}

}  // namespace splinecast::testing
