#include "support/curves.hpp"

#include <algorithm>
#include <cmath>

#include "splinecast/core/c2_spline.hpp"
#include "splinecast/core/sliding_window.hpp"
#include "support/online.hpp"

namespace splinecast::testing {
namespace {

using core::PiecewisePolynomial;
using core::Time;

core::Condition condition(bool halts) {
  return {halts ? core::ConditionKind::halt : core::ConditionKind::natural, {}};
}

}  // namespace

PiecewisePolynomial batch_curve(const Mesh& mesh, bool halts) {
  return core::c2_spline(mesh.times, mesh.positions, mesh.dimensions, condition(halts),
                         condition(halts));
}

PiecewisePolynomial online_curve(const Mesh& mesh, std::size_t settle, bool halts) {
  core::WindowOptions how;
  how.settle = settle;
  how.start = condition(halts);
  return online({.dimensions = mesh.dimensions, .times = mesh.times, .positions = mesh.positions},
                how, condition(halts));
}

PiecewisePolynomial patchwork(std::uint64_t seed, std::size_t segments, std::size_t dimensions) {
  const Mesh mesh = random_mesh(seed, segments + 1, dimensions, 3);
  PiecewisePolynomial curve(dimensions);
  for (std::size_t i = 0; i < segments; ++i) {
    const std::size_t order = 1 + (seed + 3 * i) % 8;
    std::vector<double> c = random_values(seed + i, order * dimensions);
    const double h = core::to_seconds(mesh.times[i + 1] - mesh.times[i]);
    for (std::size_t k = 0; k < c.size(); ++k) {
      c[k] /= std::pow(h, static_cast<double>(k / dimensions));
    }
    curve.append(mesh.times[i], mesh.times[i + 1], static_cast<int>(order), c);
  }
  return curve;
}

PiecewisePolynomial random_curve(std::uint64_t seed, std::size_t dimensions, double ratio) {
  const std::size_t segments = 1 + seed % 30;
  const Mesh mesh = random_mesh(seed, segments + 1, dimensions, ratio);
  switch (seed % 5) {
    case 0:
      return patchwork(seed, segments, dimensions);
    case 1:
      return batch_curve(mesh, true);
    case 2:
      return online_curve(mesh, 2, false);
    case 3:
      return online_curve(mesh, 1, true);
    default:
      return batch_curve(mesh, false);
  }
}

std::vector<Time> times_of(const PiecewisePolynomial& curve, std::int64_t per_segment) {
  std::vector<Time> times;
  for (std::size_t i = 0; i < curve.segments(); ++i) {
    const Time h = curve.right_of(i) - curve.left_of(i);
    for (std::int64_t k = 0; k < per_segment; ++k) {
      times.push_back(curve.left_of(i) + h * k / per_segment);
    }
  }
  times.push_back(curve.breaks().back());
  return times;
}

double largest(const PiecewisePolynomial& curve, int r) {
  std::vector<double> values(curve.dimensions());
  double result = 0;
  for (const Time t : times_of(curve, 20)) {
    curve.derivative(t, r, values);
    for (const double x : values) result = std::max(result, std::abs(x));
  }
  return result;
}

double largest_difference(const PiecewisePolynomial& a, const PiecewisePolynomial& b, int r) {
  std::vector<double> x(a.dimensions());
  std::vector<double> y(a.dimensions());
  double result = 0;
  for (const Time t : times_of(a, 20)) {
    a.derivative(t, r, x);
    b.derivative(t, r, y);
    for (std::size_t d = 0; d < x.size(); ++d) result = std::max(result, std::abs(x[d] - y[d]));
  }
  return result;
}

double relative_bound(double ratio, int r) { return ratio > 100 && r > 1 ? 2e-11 : 1e-12; }

}  // namespace splinecast::testing
