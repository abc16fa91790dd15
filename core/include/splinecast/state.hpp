#pragma once

#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <ranges>
#include <span>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

namespace [[gnu::visibility("default")]] splinecast {

/// Minimum and maximum number of dimensions of a stream.
inline constexpr std::size_t kMinDimensions = 1;
inline constexpr std::size_t kMaxDimensions = 64;

/// Whether a type is a vector or a matrix of Eigen, or an expression of them. Needs no Eigen.
template <class T>
concept EigenExpression = requires {
  typename T::Scalar;
  typename T::PlainObject;
  static_cast<bool>(T::IsVectorAtCompileTime);
  static_cast<int>(T::InnerStrideAtCompileTime);
};

/// An Eigen type whose values are in memory, without gaps between neighbours. A row of a
/// column-major matrix, a sum and a product are not.
template <class T>
concept EigenMemory = EigenExpression<T> && static_cast<int>(T::InnerStrideAtCompileTime) == 1 &&
                      requires(const T& values) {
  { values.data() } -> std::convertible_to<const double*>;
};

/// An Eigen vector that can be made of values in memory: a Matrix, a Map, or a Ref to const.
template <class T>
concept EigenVectorOfMemory =
    EigenExpression<T> && static_cast<bool>(T::IsVectorAtCompileTime) &&
    std::same_as<typename T::Scalar, double>&& requires(const double* data, std::ptrdiff_t size) {
  T(T::PlainObject::Map(data, size));
};

namespace core {

template <class T>
inline constexpr bool kNever = false;

/// Whether an Eigen type has its own memory, which a temporary of this type frees.
template <class T>
inline constexpr bool kOwnsValues = std::is_base_of_v<typename T::PlainObject, T>;

}  // namespace core

/// A view of the values of one derivative, one per dimension: a std::span, made also of an Eigen
/// vector in memory, and assigned to one: `Eigen::VectorXd x = state.position()`. Needs no Eigen.
/// The values must outlive the view.
class VectorView : public std::span<const double> {
 public:
  using std::span<const double>::span;
  constexpr VectorView(std::span<const double> values) noexcept : std::span<const double>(values) {}

  /// Views an Eigen vector. A compile error names what to do with a vector that has other values
  /// than double or no memory of its own, and with a temporary, which the view would outlive.
  template <class Vector>
  VectorView(Vector&& vector) noexcept requires EigenExpression<std::remove_cvref_t<Vector>>
      : std::span<const double>(view<Vector>(vector)) {}

  /// An Eigen vector with a copy of the values; a Map or Ref to const is a view. Throws
  /// std::invalid_argument, with both sizes, if a vector of fixed size has another size. Allocates
  /// only if the vector has dynamic size.
  template <EigenVectorOfMemory Vector>
  operator Vector() const {
    constexpr auto kSize = static_cast<std::ptrdiff_t>(Vector::SizeAtCompileTime);
    constexpr auto kMost = static_cast<std::ptrdiff_t>(Vector::MaxSizeAtCompileTime);
    const auto values = static_cast<std::ptrdiff_t>(size());
    if ((kSize >= 0 && values != kSize) || (kMost >= 0 && values > kMost)) {
      throw std::invalid_argument(std::to_string(values) + " values for an Eigen vector of " +
                                  std::to_string(kSize >= 0 ? kSize : kMost));
    }
    return Vector(Vector::PlainObject::Map(data(), values));
  }

 private:
  template <class Vector, class Plain = std::remove_cvref_t<Vector>>
  static std::span<const double> view(const Plain& vector) noexcept {
    constexpr bool kIsTemporary = !std::is_lvalue_reference_v<Vector> && core::kOwnsValues<Plain>;
    if constexpr (!std::same_as<typename Plain::Scalar, double>) {
      static_assert(std::same_as<typename Plain::Scalar, double>,
                    "give a vector of double: as_waypoint(t, x.cast<double>())");
      return {};
    } else if constexpr (!static_cast<bool>(Plain::IsVectorAtCompileTime)) {
      static_assert(static_cast<bool>(Plain::IsVectorAtCompileTime),
                    "give a vector, one column or one row: m.col(i); a whole matrix: as_waypoints");
      return {};
    } else if constexpr (!EigenMemory<Plain> || kIsTemporary) {
      static_assert(EigenMemory<Plain> && !kIsTemporary,
                    "this expression, strided row or temporary has no memory that lasts: "
                    "use as_waypoint(t, ...) of splinecast/eigen.hpp, which copies it");
      return {};
    } else {
      return {vector.data(), static_cast<std::size_t>(vector.size())};
    }
  }
};

}  // namespace splinecast
/// @cond
template <>
inline constexpr bool std::ranges::enable_borrowed_range<splinecast::VectorView> = true;
template <>
inline constexpr bool std::ranges::enable_view<splinecast::VectorView> = true;
/// @endcond
namespace [[gnu::visibility("default")]] splinecast {

/// The output of a sample: position [unit], velocity [unit/s], acceleration [unit/s²] and jerk
/// [unit/s³], one value per dimension in each span. Does not own its memory.
struct StateRef {
  std::span<double> position;
  std::span<double> velocity;
  std::span<double> acceleration;
  std::span<double> jerk;
};

/// A state that owns its memory. Only the constructor allocates; one object can be used for any
/// number of samples.
class State {
 public:
  /// Makes a zero state of `dimensions` values per derivative.
  explicit State(std::size_t dimensions) : dimensions_(dimensions), values_(4 * dimensions) {}

  [[nodiscard]] std::size_t dimensions() const noexcept { return dimensions_; }
  [[nodiscard]] VectorView position() const noexcept { return part(0); }
  [[nodiscard]] VectorView velocity() const noexcept { return part(1); }
  [[nodiscard]] VectorView acceleration() const noexcept { return part(2); }
  [[nodiscard]] VectorView jerk() const noexcept { return part(3); }

  /// All 4·D values: positions, velocities, accelerations, jerks.
  [[nodiscard]] std::span<const double> values() const noexcept { return values_; }

  /// The memory of this state, for an evaluation to write to.
  [[nodiscard]] StateRef ref() noexcept {
    const std::span<double> all(values_);
    return {all.subspan(0, dimensions_), all.subspan(dimensions_, dimensions_),
            all.subspan(2 * dimensions_, dimensions_), all.subspan(3 * dimensions_, dimensions_)};
  }

 private:
  [[nodiscard]] VectorView part(std::size_t derivative) const noexcept {
    return std::span<const double>(values_).subspan(derivative * dimensions_, dimensions_);
  }

  std::size_t dimensions_;
  std::vector<double> values_;
};

/// A set of derivatives to evaluate. Values of several derivatives are stored in this order. The
/// bit of the r-th derivative is 1 << r.
enum class Derivatives : std::uint8_t {
  none = 0,
  position = 1,
  velocity = 2,
  acceleration = 4,
  jerk = 8,
  all = 15,
};

[[nodiscard]] constexpr Derivatives operator|(Derivatives a, Derivatives b) noexcept {
  return static_cast<Derivatives>(static_cast<std::uint8_t>(a) | static_cast<std::uint8_t>(b));
}

/// Whether `set` has all of `wanted`.
[[nodiscard]] constexpr bool contains(Derivatives set, Derivatives wanted) noexcept {
  return (set | wanted) == set;
}

/// Number of derivatives in the set: 0 … 4.
[[nodiscard]] constexpr std::size_t count(Derivatives set) noexcept {
  return static_cast<std::size_t>(std::popcount(static_cast<std::uint8_t>(set)));
}

}  // namespace splinecast
