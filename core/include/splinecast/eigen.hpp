#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>

#include "splinecast/state.hpp"

/// Inline views for programs that use Eigen. Needs Eigen 3, which the package does not require. No
/// Eigen type crosses a compiled interface, because its alignment depends on compiler flags.
namespace [[gnu::visibility("default")]] splinecast {

/// Views the values of one derivative as a column vector of `Dimensions` rows; no copy. The span
/// must hold `Dimensions` values (any number for Eigen::Dynamic) and outlive the view.
template <int Dimensions = Eigen::Dynamic>
[[nodiscard]] Eigen::Map<const Eigen::Matrix<double, Dimensions, 1>> as_vector(
    std::span<const double> values) noexcept {
  return Eigen::Map<const Eigen::Matrix<double, Dimensions, 1>>(
      values.data(), static_cast<Eigen::Index>(values.size()));
}

/// A state of fixed size in Eigen vectors, for programs whose dimensions are known at compile time.
template <int Dimensions>
struct EigenState {
  Eigen::Matrix<double, Dimensions, 1> position, velocity, acceleration, jerk;

  /// The memory of this state, for an evaluation to write to.
  [[nodiscard]] StateRef ref() noexcept {
    constexpr auto kSize = static_cast<std::size_t>(Dimensions);
    return {{position.data(), kSize},
            {velocity.data(), kSize},
            {acceleration.data(), kSize},
            {jerk.data(), kSize}};
  }
};

}  // namespace splinecast
