#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <bit>
#include <concepts>
#include <cstddef>
#include <span>
#include <stdexcept>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "splinecast/dimension_kind.hpp"
#include "splinecast/piecewise_polynomial.hpp"
#include "splinecast/snapshot.hpp"
#include "splinecast/state.hpp"
#include "splinecast/status.hpp"
#include "splinecast/time.hpp"
#include "splinecast/waypoint.hpp"

/// Waypoints, states, horizons and poses as Eigen types, for programs that use Eigen 3.4: the
/// component `eigen` of the package. Everything is inline, and only copies values. No Eigen type
/// crosses a compiled interface, because its alignment depends on compiler flags.
///
/// `Dimensions` is the number of dimensions, or Eigen::Dynamic if it is known only at run time.
namespace [[gnu::visibility("default")]] splinecast {

/// Views the values of one derivative as a column vector of `Dimensions` rows; no copy. The span
/// must hold `Dimensions` values (any number for Eigen::Dynamic) and outlive the view.
template <int Dimensions = Eigen::Dynamic>
[[nodiscard]] Eigen::Map<const Eigen::Matrix<double, Dimensions, 1>> as_vector(
    std::span<const double> values) noexcept {
  return Eigen::Map<const Eigen::Matrix<double, Dimensions, 1>>(
      values.data(), static_cast<Eigen::Index>(values.size()));
}

/// Views a contiguous vector as a span, of const values if they are const; no copy. The values must
/// outlive the span. A compile error refuses an expression, a strided row and a temporary.
template <class Vector>
[[nodiscard]] auto as_span(Vector&& vector) noexcept {
  const VectorView view(std::forward<Vector>(vector));
  if constexpr (requires { std::span<double>(vector.data(), view.size()); }) {
    return std::span<double>(vector.data(), view.size());
  } else {
    return std::span<const double>(view);
  }
}

/// A position and an orientation.
using PoseVector = Eigen::Matrix<double, 7, 1>;

/// The four values of a rotation in the order of its kind: x y z w of `quaternion`, w x y z of
/// `quaternion_wxyz`.
[[nodiscard]] inline Eigen::Vector4d as_values(
    const Eigen::Quaterniond& rotation, DimensionKind kind = DimensionKind::quaternion) noexcept {
  if (kind != DimensionKind::quaternion_wxyz) return rotation.coeffs();
  return {rotation.w(), rotation.x(), rotation.y(), rotation.z()};
}

/// A pose as seven values: x y z of three linear dimensions, then those of a quaternion of `kind`.
[[nodiscard]] inline PoseVector as_pose(const Eigen::Isometry3d& pose,
                                        DimensionKind kind = DimensionKind::quaternion) noexcept {
  PoseVector values;
  values << pose.translation(), as_values(Eigen::Quaterniond(pose.linear()), kind);
  return values;
}

/// The rotation of the four values of a quaternion, as sampled: its length is 1. Throws
/// std::invalid_argument for another number of values.
[[nodiscard]] inline Eigen::Quaterniond as_quaternion(
    const VectorView& values, DimensionKind kind = DimensionKind::quaternion) {
  const Eigen::Vector4d q = values;
  return kind == DimensionKind::quaternion_wxyz ? Eigen::Quaterniond(q[0], q[1], q[2], q[3])
                                                : Eigen::Quaterniond(q);
}

/// The pose of seven values: the inverse of as_pose(). Throws std::invalid_argument for another
/// number of values.
[[nodiscard]] inline Eigen::Isometry3d as_isometry(const VectorView& values,
                                                   DimensionKind kind = DimensionKind::quaternion) {
  const PoseVector pose = values;
  Eigen::Isometry3d isometry = Eigen::Isometry3d::Identity();
  isometry.linear() = as_quaternion(values.subspan(3), kind).toRotationMatrix();
  isometry.translation() = pose.head<3>();
  return isometry;
}

namespace core {

/// A Ref to a const type may own a copy.
template <class T, int Options, class Stride>
inline constexpr bool kOwnsValues<Eigen::Ref<const T, Options, Stride>> = true;

/// A copy of a vector on the stack.
template <class T, int kSize = static_cast<int>(T::SizeAtCompileTime)>
using StackVector =
    Eigen::Matrix<double, kSize, 1, 0,
                  kSize == Eigen::Dynamic ? static_cast<int>(kMaxDimensions) : kSize, 1>;

/// Evaluates a vector on the stack. Throws std::invalid_argument if it is too long.
template <class T>
[[nodiscard]] StackVector<T> on_stack(const T& vector) {
  if (vector.size() > static_cast<Eigen::Index>(kMaxDimensions)) {
    throw std::invalid_argument("a vector of " + std::to_string(vector.size()) +
                                " values; a stream has at most " + std::to_string(kMaxDimensions));
  }
  if constexpr (static_cast<int>(T::ColsAtCompileTime) == 1) {
    return StackVector<T>(vector.matrix());
  } else {
    return StackVector<T>(vector.matrix().transpose());
  }
}

/// One derivative of a waypoint: a view of memory that lasts, or a copy on the stack.
template <class T, class Plain = std::remove_cvref_t<T>>
[[nodiscard]] auto part(T&& values) {
  if constexpr (std::same_as<Plain, Eigen::Isometry3d>) {
    return as_pose(values);
  } else if constexpr (std::same_as<Plain, Eigen::Quaterniond>) {
    return as_values(values);
  } else if constexpr (std::convertible_to<T, std::span<const double>>) {
    return VectorView(values);
  } else if constexpr (!is_vector<T>()) {
    return VectorView();
  } else if constexpr (Lasting<T>) {
    return VectorView(std::forward<T>(values));
  } else {
    return on_stack(values);
  }
}

}  // namespace core

/// A waypoint or an instant with copies on the stack of vectors that are not in memory. Converts to
/// `Point`, which is valid as long as this object: until the end of the call that it is an argument
/// of, or give it a name with `const auto`.
template <class Point, class... Parts>
class EigenPoint {
 public:
  EigenPoint(Time time, const Parts&... parts) : time_(time), parts_(parts...) {}
  operator Point() const noexcept {
    return std::apply(
        [&](const auto&... parts) {
          return Point{time_, VectorView(parts)...};
        },
        parts_);
  }

 private:
  Time time_;
  std::tuple<Parts...> parts_;
};

namespace core {

template <class Point, class... Parts>
[[nodiscard]] auto point(Time time, const Parts&... parts) {
  return EigenPoint<Point, Parts...>(time, parts...);
}
template <class Point, std::same_as<VectorView>... Views>
[[nodiscard]] Point point(Time time, const Views&... parts) {
  return {time, parts...};
}

template <class Point, class State>
[[nodiscard]] Point point_of(Time time, State&& state) requires requires {
  state.acceleration;
}
{ return {time, state.position, state.velocity, state.acceleration}; }
template <class Point, class... Vectors>
[[nodiscard]] auto point_of(Time time, Vectors&&... vectors) {
  if constexpr (sizeof...(Vectors) >= 1 && sizeof...(Vectors) <= 3) {
    return point<Point>(time, part(std::forward<Vectors>(vectors))...);
  } else {
    static_assert(kNever<Point>,
                  "as_waypoint: give a time, a position and, optionally, a velocity and an "
                  "acceleration; or a time and an EigenState");
  }
}

}  // namespace core

/// A waypoint of vectors: a position and, optionally, a velocity and an acceleration; or of an
/// EigenState. For `producer.append(as_waypoint(t, x + v * dt))`.
///
/// Columns, rows, maps, and contiguous parts such as `m.col(i)` and `x.head<3>()`, are viewed: then
/// the result is a Waypoint, and the values must outlive it. An expression, a temporary, a row of a
/// column-major matrix, an Isometry3d (see as_pose) and a Quaterniond are copied to the stack: then
/// the result is an EigenPoint, which converts to a Waypoint and must outlive that. Cannot detect a
/// view of a temporary: `f().head(3)`.
///
/// Allocates nothing, unless Eigen itself does: for a product inside of another expression. Throws
/// std::invalid_argument if a copied vector has more than kMaxDimensions values. O(D).
template <class... Vectors>
[[nodiscard]] auto as_waypoint(Time time, Vectors&&... vectors) {
  return core::point_of<Waypoint>(time, std::forward<Vectors>(vectors)...);
}

/// The same for Producer::start_from: an Instant.
template <class... Vectors>
[[nodiscard]] auto as_instant(Time time, Vectors&&... vectors) {
  return core::point_of<Instant>(time, std::forward<Vectors>(vectors)...);
}

/// Views a recording of n waypoints: n times; positions and, optionally, velocities and
/// accelerations as D × n column-major matrices with one column per waypoint, or as n × D row-major
/// ones with one row per waypoint; for one dimension, a vector. For fit() and
/// Producer::replace_from(). No copy: times and values must outlive the result.
///
/// Refuses at compile time an expression and a temporary. Throws std::invalid_argument, with the
/// shapes, if a matrix has not one column, or row, per time, if the matrices differ in dimensions,
/// or if there are gaps (a block of some rows of a column-major matrix). O(1), allocates nothing.
template <class Positions, class... Further>
[[nodiscard]] Waypoints as_waypoints(std::span<const Time> times, Positions&& positions,
                                     Further&&... further) {
  static_assert(sizeof...(Further) <= 2, "as_waypoints: give positions, velocities, accelerations");
  if constexpr (core::is_matrix_in_memory<Positions>() &&
                (core::is_matrix_in_memory<Further>() && ...)) {
    const std::size_t dimensions = core::lists_of(positions, times.size()).size;
    const std::array<std::span<const double>, 2> given{
        core::values_of(further, times.size(), dimensions)...};
    return {.dimensions = dimensions,
            .times = times,
            .positions = core::values_of(positions, times.size(), dimensions),
            .velocities = given[0],
            .accelerations = given[1]};
  } else {
    return {};
  }
}

/// The memory that Reader::sample_many writes to: a matrix with one column per time (or a row-major
/// one with one row), which has the values of the stored derivatives, position first: D × N for
/// positions. Throws std::invalid_argument as as_waypoints() does.
template <class Matrix>
[[nodiscard]] SampleBlock as_block(Matrix&& matrix, std::span<SampleStatus> status,
                                   Derivatives derivatives = Derivatives::position) {
  if constexpr (core::is_matrix_in_memory<Matrix>()) {
    const std::size_t size = core::lists_of(matrix, status.size()).size;
    return {.values = core::values_of(matrix, status.size(), size),
            .status = status,
            .derivatives = derivatives};
  } else {
    return {};
  }
}

/// A state in Eigen vectors of fixed or dynamic size. Only constructors and copies of a dynamic one
/// allocate.
template <int Dimensions = Eigen::Dynamic>
struct EigenState {
  using Vector = Eigen::Matrix<double, Dimensions, 1>;

  Vector position, velocity, acceleration, jerk;

  /// Makes a zero state.
  EigenState() requires(Dimensions != Eigen::Dynamic) : EigenState(Vector(Vector::Zero())) {}
  explicit EigenState(std::size_t dimensions) requires(Dimensions == Eigen::Dynamic)
      : EigenState(Vector(Vector::Zero(static_cast<Eigen::Index>(dimensions)))) {}

  [[nodiscard]] std::size_t dimensions() const noexcept {
    return static_cast<std::size_t>(position.size());
  }

  /// The memory of this state, for an evaluation to write to: `reader.sample(t, state)`.
  [[nodiscard]] StateRef ref() noexcept {
    const std::size_t size = dimensions();
    return {{position.data(), size},
            {velocity.data(), size},
            {acceleration.data(), size},
            {jerk.data(), size}};
  }
  operator StateRef() & noexcept { return ref(); }

 private:
  explicit EigenState(const Vector& zero)
      : position(zero), velocity(zero), acceleration(zero), jerk(zero) {}
};

/// Evaluates a curve at a time between its first and its last break, with the bits of
/// PiecewisePolynomial::evaluate. Requires a non-empty curve. Throws std::invalid_argument if the
/// state has other dimensions than the curve. Allocates nothing. O(log n + order·D).
template <int Dimensions>
void evaluate(const PiecewisePolynomial& curve, Time t, EigenState<Dimensions>& out) {
  if (curve.dimensions() != out.dimensions()) {
    throw std::invalid_argument("a curve of " + std::to_string(curve.dimensions()) +
                                " dimensions, a state of " + std::to_string(out.dimensions()));
  }
  curve.evaluate(t, out.ref());
}

/// The memory of a horizon: N times, and the states of one revision at these times, for
/// Reader::sample_many. Stores the derivatives of the set `kStored`.
///
///     EigenHorizon<7> horizon(50);
///     horizon.set_times(clock.now(), 2ms);
///     const std::uint64_t revision = reader.sample_many(horizon.times(), horizon);
///     if (revision != 0 && horizon.is_complete()) use(horizon.position());  // 7 × 50
///
/// Constructors and copies allocate, other functions do not. One thread uses it. Views are valid
/// until the horizon is destroyed, assigned or moved.
template <int Dimensions = Eigen::Dynamic, Derivatives kStored = Derivatives::all>
class EigenHorizon {
  static constexpr int kRows =
      Dimensions == Eigen::Dynamic ? Eigen::Dynamic : Dimensions * static_cast<int>(count(kStored));

 public:
  /// One column per time: position, then velocity, acceleration and jerk, if they are stored.
  using States = Eigen::Matrix<double, kRows, Eigen::Dynamic>;
  /// D rows of all states. The columns are contiguous, with the height of States between them.
  using View = Eigen::Block<const States, Dimensions, Eigen::Dynamic>;

  /// Makes a horizon of N times: all 0, without data.
  explicit EigenHorizon(std::size_t times) requires(Dimensions != Eigen::Dynamic)
      : EigenHorizon(times, Dimensions, Sizes{}) {}
  EigenHorizon(std::size_t times, std::size_t dimensions) requires(Dimensions == Eigen::Dynamic)
      : EigenHorizon(times, static_cast<Eigen::Index>(dimensions), Sizes{}) {}

  [[nodiscard]] std::size_t size() const noexcept { return times_.size(); }
  [[nodiscard]] std::size_t dimensions() const noexcept {
    return static_cast<std::size_t>(dimensions_);
  }

  /// The N times to sample, in any order.
  [[nodiscard]] std::span<Time> times() noexcept { return times_; }
  [[nodiscard]] std::span<const Time> times() const noexcept { return times_; }

  /// Sets time i to begin + i·step. All must be within ±2⁶² ns.
  void set_times(Time begin, Time step) noexcept {
    for (Time& time : times_) {
      time = begin;
      begin += step;
    }
  }

  /// The memory that Reader::sample_many writes to.
  [[nodiscard]] SampleBlock block() noexcept {
    return {.values = {states_.data(), static_cast<std::size_t>(states_.size())},
            .status = status_,
            .derivatives = kStored};
  }
  operator SampleBlock() & noexcept { return block(); }

  /// The status of each time.
  [[nodiscard]] std::span<const SampleStatus> status() const noexcept { return status_; }

  /// Whether every time has values. Values of a time without them are undefined. O(N).
  [[nodiscard]] bool is_complete() const noexcept {
    return std::ranges::all_of(status_, [](SampleStatus status) { return has_values(status); });
  }

  /// All stored values: (D · number of derivatives) × N. Column i is the state at time i.
  [[nodiscard]] const States& states() const noexcept { return states_; }

  /// One derivative: D × N, column i at time i. Exists only for a derivative that is stored.
  [[nodiscard]] View position() const noexcept requires(contains(kStored, Derivatives::position)) {
    return part(Derivatives::position);
  }
  [[nodiscard]] View velocity() const noexcept requires(contains(kStored, Derivatives::velocity)) {
    return part(Derivatives::velocity);
  }
  [[nodiscard]] View acceleration() const noexcept
      requires(contains(kStored, Derivatives::acceleration)) {
    return part(Derivatives::acceleration);
  }
  [[nodiscard]] View jerk() const noexcept requires(contains(kStored, Derivatives::jerk)) {
    return part(Derivatives::jerk);
  }

 private:
  struct Sizes {};

  EigenHorizon(std::size_t times, Eigen::Index dimensions, Sizes /*tag*/)
      : times_(times),
        status_(times, SampleStatus::no_data),
        dimensions_(dimensions),
        states_(States::Zero(dimensions * static_cast<Eigen::Index>(count(kStored)),
                             static_cast<Eigen::Index>(times))) {}

  /// The rows of a derivative: those of the stored derivatives before it come first.
  [[nodiscard]] View part(Derivatives one) const noexcept {
    const unsigned before = static_cast<unsigned>(kStored) & (static_cast<unsigned>(one) - 1);
    return View(states_, std::popcount(before) * dimensions_, 0, dimensions_, states_.cols());
  }

  std::vector<Time> times_;
  std::vector<SampleStatus> status_;
  Eigen::Index dimensions_ = 0;
  States states_;
};

}  // namespace splinecast
