#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <bit>
#include <concepts>
#include <cstddef>
#include <span>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "splinecast/piecewise_polynomial.hpp"
#include "splinecast/snapshot.hpp"
#include "splinecast/state.hpp"
#include "splinecast/status.hpp"
#include "splinecast/time.hpp"
#include "splinecast/waypoint.hpp"

/// Waypoints, states and horizons as Eigen vectors and matrices, for programs that use Eigen 3.4:
/// the component `eigen` of the package. Everything is inline. No Eigen type crosses a compiled
/// interface, because its alignment depends on compiler flags.
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

/// Whether an Eigen type has its own memory, which a temporary of this type frees. A Ref to a const
/// type may own a copy.
template <class T>
inline constexpr bool kOwnsValues = std::is_base_of_v<typename T::PlainObject, T>;
template <class T, int Options, class Stride>
inline constexpr bool kOwnsValues<Eigen::Ref<const T, Options, Stride>> = true;

/// Whether the values of an Eigen type are in memory, and neighbours in it are contiguous.
template <class T>
inline constexpr bool kIsContiguous = (static_cast<unsigned>(T::Flags) & Eigen::DirectAccessBit) !=
                                          0 &&
                                      static_cast<int>(T::InnerStrideAtCompileTime) == 1;

/// An Eigen expression of contiguous doubles. A temporary must be a view (a Map, or a block of a
/// matrix), because it does not free the values.
template <class T, class Plain = std::remove_cvref_t<T>>
concept EigenValues = std::same_as<typename Plain::Scalar, double> && kIsContiguous<Plain> &&
    (std::is_lvalue_reference_v<T> || !kOwnsValues<Plain>);

/// A contiguous vector: a column or a row, of fixed or dynamic size. For example `x`, `x.head<3>()`
/// and `columns.col(i)`, but not `x + y` and not a row of a column-major matrix.
template <class T>
concept EigenVector = EigenValues<T> &&
    static_cast<bool>(std::remove_cvref_t<T>::IsVectorAtCompileTime);

/// A row-major matrix, or a column vector: one row per waypoint. The transposed view of a
/// column-major matrix with one *column* per waypoint is row-major: `columns.transpose()`. To use a
/// column-major matrix with one row per waypoint, copy it to a row-major one.
template <class T>
concept EigenRows = EigenValues<T> &&
    (static_cast<bool>(std::remove_cvref_t<T>::IsRowMajor) ||
     static_cast<int>(std::remove_cvref_t<T>::ColsAtCompileTime) == 1);

/// Views a vector as a span; no copy. The values must outlive the span. Refuses at compile time a
/// temporary that owns its values. Cannot detect a view of a temporary: `f().head(3)`.
template <EigenVector Vector>
[[nodiscard]] std::span<const double> as_span(Vector&& vector) noexcept {
  return {vector.data(), static_cast<std::size_t>(vector.size())};
}

/// Views vectors as a waypoint: position and, optionally, velocity and acceleration. No copy; see
/// as_span. The values must outlive the waypoint; Producer::append needs them only during its call.
template <EigenVector Position, EigenVector... Further>
[[nodiscard]] Waypoint as_waypoint(Time time, Position&& position, Further&&... further) noexcept
    requires(sizeof...(Further) <= 2) {
  const std::array<std::span<const double>, 2> given{as_span(std::forward<Further>(further))...};
  return {.time = time,
          .position = as_span(std::forward<Position>(position)),
          .velocity = given[0],
          .acceleration = given[1]};
}

namespace core {

/// Views a matrix of `rows` rows and `columns` columns as one contiguous span. Throws
/// std::invalid_argument if it has another shape, or gaps between its rows.
template <EigenRows Matrix>
[[nodiscard]] std::span<const double> rows_of(Matrix&& matrix, std::size_t rows,
                                              std::size_t columns) {
  const auto n = static_cast<std::size_t>(matrix.rows());
  const auto width = static_cast<std::size_t>(matrix.cols());
  const auto stride =
      matrix.IsVectorAtCompileTime ? width : static_cast<std::size_t>(matrix.outerStride());
  if (n != rows || width != columns || (n > 1 && stride != columns)) {
    throw std::invalid_argument("a matrix of " + std::to_string(n) + " x " + std::to_string(width) +
                                " values, " + std::to_string(stride) +
                                " from row to row; expected " + std::to_string(rows) + " x " +
                                std::to_string(columns) + " contiguous values");
  }
  return {matrix.data(), rows * columns};
}

}  // namespace core

/// Views a recording of n waypoints: n times; positions and, optionally, velocities and
/// accelerations as row-major matrices with one row per waypoint and one column per dimension. No
/// copy: times and values must outlive the result. Refuses a column-major matrix at compile time.
/// Throws std::invalid_argument, with the shapes, if a matrix does not have n rows, if the matrices
/// differ in columns, or if rows are not contiguous (a block of a wider matrix). O(1).
template <EigenRows Positions, EigenRows... Further>
[[nodiscard]] Waypoints as_waypoints(std::span<const Time> times, Positions&& positions,
                                     Further&&... further) requires(sizeof...(Further) <= 2) {
  const auto dimensions = static_cast<std::size_t>(positions.cols());
  const std::array<std::span<const double>, 2> given{
      core::rows_of(std::forward<Further>(further), times.size(), dimensions)...};
  return {.dimensions = dimensions,
          .times = times,
          .positions = core::rows_of(std::forward<Positions>(positions), times.size(), dimensions),
          .velocities = given[0],
          .accelerations = given[1]};
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

  /// The memory of this state, for Reader::sample and other evaluations to write to.
  [[nodiscard]] StateRef ref() noexcept {
    const std::size_t size = dimensions();
    return {{position.data(), size},
            {velocity.data(), size},
            {acceleration.data(), size},
            {jerk.data(), size}};
  }

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
///     const std::uint64_t revision = reader.sample_many(horizon.times(), horizon.block());
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
