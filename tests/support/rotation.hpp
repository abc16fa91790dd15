#pragma once

#include <array>

#include "splinecast/core/dimension_kind.hpp"

namespace splinecast::testing {

/// A body that cones about a tilted axis while it spins: its angular motion is known exactly.
/// q(t) = tilt ⊗ z(precession·t) ⊗ x(nutation) ⊗ z(spin·t), as x y z w, taking body to world.
struct Coning {
  double precession = 3;  ///< rad/s
  double spin = 4;        ///< rad/s
  double nutation = 0.7;  ///< rad

  [[nodiscard]] std::array<double, 4> quaternion(double seconds) const;

  /// ω and α in the body's frame.
  [[nodiscard]] core::AngularMotion motion(double seconds) const;

  /// The largest length of the quaternion's k-th derivative: it is made of sines of two
  /// frequencies, half the sum and half the difference of the rates.
  [[nodiscard]] double derivative_bound(int k) const;
};

/// The largest difference of two vectors' components.
[[nodiscard]] double difference(const core::Vector3& a, const core::Vector3& b);

}  // namespace splinecast::testing
