#include "support/rotation.hpp"

#include <algorithm>
#include <cmath>

namespace splinecast::testing {
namespace {

using Quaternion = std::array<double, 4>;  // x y z w

Quaternion product(const Quaternion& a, const Quaternion& b) {
  const auto& [ax, ay, az, aw] = a;
  const auto& [bx, by, bz, bw] = b;
  return {aw * bx + ax * bw + ay * bz - az * by, aw * by - ax * bz + ay * bw + az * bx,
          aw * bz + ax * by - ay * bx + az * bw, aw * bw - ax * bx - ay * by - az * bz};
}

Quaternion about_x(double angle) { return {std::sin(angle / 2), 0, 0, std::cos(angle / 2)}; }
Quaternion about_z(double angle) { return {0, 0, std::sin(angle / 2), std::cos(angle / 2)}; }

}  // namespace

std::array<double, 4> Coning::quaternion(double seconds) const {
  const Quaternion tilt = product(about_x(0.5), about_z(1.1));
  return product(product(tilt, about_z(precession * seconds)),
                 product(about_x(nutation), about_z(spin * seconds)));
}

core::AngularMotion Coning::motion(double seconds) const {
  const double across = precession * std::sin(nutation);
  const double s = std::sin(spin * seconds);
  const double c = std::cos(spin * seconds);
  return {.velocity = {across * s, across * c, spin + precession * std::cos(nutation)},
          .acceleration = {across * spin * c, -across * spin * s, 0}};
}

double Coning::derivative_bound(int k) const {
  return std::pow((std::abs(precession) + std::abs(spin)) / 2, k);
}

double difference(const core::Vector3& a, const core::Vector3& b) {
  double most = 0;
  for (std::size_t k = 0; k < a.size(); ++k) most = std::max(most, std::abs(a[k] - b[k]));
  return most;
}

}  // namespace splinecast::testing
