#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <type_traits>

#include "splinecast/state.hpp"
#include "splinecast/time.hpp"

namespace [[gnu::visibility("default")]] splinecast {

/// The largest magnitude of a position, velocity or acceleration. Far above any real value, and
/// small enough that no formula overflows.
inline constexpr double kLargestValue = 1e100;

/// Whether a value is valid: not NaN and within ±kLargestValue.
[[nodiscard]] constexpr bool is_usable(double value) noexcept {
  return value >= -kLargestValue && value <= kLargestValue;  // false for NaN
}

/// The earliest and latest times: the difference of any two fits into 64 bits.
inline constexpr Time kLatestTime{(std::int64_t{1} << 62U) - 1};
static_assert(kLatestTime - -kLatestTime > Time::zero());
[[nodiscard]] constexpr bool is_time_in_range(Time time) noexcept {
  return time >= -kLatestTime && time <= kLatestTime;
}

/// The input from a producer: a time, a position and, optionally, velocity and acceleration. Views
/// hold one value per dimension; an empty one means "not given". Does not own its values, which may
/// be a std::vector, std::array, std::span or an Eigen vector: `{.time = t, .position = x}`.
struct Waypoint {
  Time time{};
  VectorView position{};
  VectorView velocity{};
  VectorView acceleration{};
};

/// A state at an instant. Views hold one value per dimension; does not own them.
struct Instant {
  Time time{};
  VectorView position{};
  VectorView velocity{};
  VectorView acceleration{};
};

/// Waypoints of a whole recording: values are [waypoint][dimension]; `velocities` and
/// `accelerations` are empty if not given. A view: it owns nothing.
struct Waypoints {
  std::size_t dimensions = 0;
  std::span<const Time> times{};
  std::span<const double> positions{};
  std::span<const double> velocities{};
  std::span<const double> accelerations{};

  [[nodiscard]] std::size_t size() const noexcept { return times.size(); }
  [[nodiscard]] Waypoint operator[](std::size_t i) const noexcept {
    const auto row = [&](std::span<const double> values) {
      return values.empty() ? values : values.subspan(i * dimensions, dimensions);
    };
    return {.time = times[i],
            .position = row(positions),
            .velocity = row(velocities),
            .acceleration = row(accelerations)};
  }
};

/// Matrices of Eigen as waypoints, without Eigen: for splinecast/eigen.hpp.
namespace core {

/// Whether an argument is in memory that lasts longer than the call.
template <class T, class Plain = std::remove_cvref_t<T>>
concept Lasting = EigenMemory<Plain> &&(std::is_lvalue_reference_v<T> || !kOwnsValues<Plain>);

/// The shape of a matrix in memory: `count` contiguous lists of `size` values, `stride` apart.
struct Lists {
  std::size_t count, size, stride;
};

/// The columns of a column-major matrix, the rows of a row-major one. A vector is one list, or, if
/// there are as many times as values, one value per time.
template <class Matrix>
[[nodiscard]] Lists lists_of(const Matrix& matrix, std::size_t times) noexcept {
  if constexpr (static_cast<bool>(Matrix::IsVectorAtCompileTime)) {
    const auto size = static_cast<std::size_t>(matrix.size());
    return size == times ? Lists{size, 1, 1} : Lists{1, size, size};
  } else {
    return {static_cast<std::size_t>(matrix.outerSize()),
            static_cast<std::size_t>(matrix.innerSize()),
            static_cast<std::size_t>(matrix.outerStride())};
  }
}

/// Views a matrix of one list per time as one contiguous span. Throws std::invalid_argument if it
/// has another shape, or gaps between its lists.
template <class Matrix>
[[nodiscard]] auto values_of(Matrix&& matrix, std::size_t times, std::size_t size) {
  using Plain = std::remove_cvref_t<Matrix>;
  const Lists lists = lists_of(matrix, times);
  if (lists.count != times || lists.size != size || (times > 1 && lists.stride != size)) {
    const std::string list = static_cast<bool>(Plain::IsRowMajor) ? "row" : "column";
    throw std::invalid_argument("a matrix of " + std::to_string(matrix.rows()) + " x " +
                                std::to_string(matrix.cols()) + " values, " +
                                std::to_string(lists.stride) + " from " + list + " to " + list +
                                "; expected " + std::to_string(times) + " contiguous " + list +
                                "s of " + std::to_string(size) + " values, one per time");
  }
  return std::span(matrix.data(), times * size);
}

/// Refuses at compile time what is not a vector of double.
template <class T, class Plain = std::remove_cvref_t<T>>
[[nodiscard]] constexpr bool is_vector() noexcept {
  if constexpr (!EigenExpression<Plain>) {
    static_assert(kNever<T>,
                  "as_waypoint: give vectors of double, an Isometry3d or a Quaterniond; of an "
                  "Affine3d or a pose of float make an Isometry3d");
  } else if constexpr (!std::same_as<typename Plain::Scalar, double>) {
    static_assert(kNever<T>, "as_waypoint: give vectors of double; for float use .cast<double>()");
  } else if constexpr (!static_cast<bool>(Plain::IsVectorAtCompileTime)) {
    static_assert(kNever<T>,
                  "as_waypoint: give a vector, one column or one row: m.col(i), m.row(i) or "
                  "VectorXd; for a whole matrix use as_waypoints");
  } else {
    return true;
  }
  return false;
}

/// Refuses at compile time what is not a matrix of double in memory that lasts.
template <class Matrix, class Plain = std::remove_cvref_t<Matrix>>
[[nodiscard]] constexpr bool is_matrix_in_memory() noexcept {
  if constexpr (!EigenExpression<Plain>) {
    static_assert(kNever<Matrix>, "as_waypoints: give the times and matrices of Eigen");
  } else if constexpr (!std::same_as<typename Plain::Scalar, double>) {
    static_assert(kNever<Matrix>,
                  "as_waypoints: give matrices of double; for float store .cast<double>() in a "
                  "variable");
  } else if constexpr (!Lasting<Matrix>) {
    static_assert(kNever<Matrix>,
                  "as_waypoints: store the expression or temporary in a variable and give that, "
                  "because a recording is not copied");
  } else {
    return true;
  }
  return false;
}

}  // namespace core

}  // namespace splinecast
