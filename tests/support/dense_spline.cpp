#include "support/dense_spline.hpp"

namespace splinecast::testing {
namespace {

using core::Condition;
using core::ConditionKind;
using core::Tail;

/// The equations A v = b, filled row by row.
struct System {
  const Mesh& mesh;
  Eigen::MatrixXd a;
  Eigen::MatrixXd b;

  explicit System(const Mesh& waypoints) : mesh(waypoints) {
    const auto n = static_cast<Eigen::Index>(mesh.size());
    a = Eigen::MatrixXd::Zero(n, n);
    b = Eigen::MatrixXd::Zero(n, static_cast<Eigen::Index>(mesh.dimensions));
    for (Eigen::Index i = 1; i + 1 < n; ++i) {
      a(i, i - 1) = h(i);
      a(i, i) = 2 * (h(i - 1) + h(i));
      a(i, i + 1) = h(i - 1);
      b.row(i) = 3 * (h(i) * chord(i - 1) + h(i - 1) * chord(i));
    }
  }
  [[nodiscard]] double h(Eigen::Index i) const {
    const auto at = static_cast<std::size_t>(i);
    return static_cast<double>((mesh.times[at + 1] - mesh.times[at]).count()) * 1e-9;
  }
  [[nodiscard]] Eigen::RowVectorXd chord(Eigen::Index i) const {
    const auto at = static_cast<std::size_t>(i);
    const auto x0 = mesh.position(at);
    const auto x1 = mesh.position(at + 1);
    Eigen::RowVectorXd m(b.cols());
    for (Eigen::Index d = 0; d < m.size(); ++d) {
      m(d) = (x1[static_cast<std::size_t>(d)] - x0[static_cast<std::size_t>(d)]) / h(i);
    }
    return m;
  }
  /// Row i of an end whose only interval is `interval` and whose neighbour is knot `inner`.
  void end_row(const Condition& condition, Eigen::Index i, Eigen::Index inner,
               Eigen::Index interval) {
    const bool gives_acceleration =
        condition.kind == ConditionKind::natural || condition.kind == ConditionKind::acceleration;
    Eigen::RowVectorXd value = Eigen::RowVectorXd::Zero(b.cols());
    for (std::size_t d = 0; d < condition.value.size(); ++d) {
      value(static_cast<Eigen::Index>(d)) = condition.value[d];
    }
    a(i, i) = gives_acceleration ? 2 : 1;
    if (gives_acceleration) {
      a(i, inner) = 1;
      value = 3 * chord(interval) + (i < inner ? -0.5 : 0.5) * h(interval) * value;
    }
    b.row(i) = value;
  }
  [[nodiscard]] Eigen::MatrixXd solve() const { return a.partialPivLu().solve(b); }
};

}  // namespace

Eigen::MatrixXd dense_velocities(const Mesh& mesh, const Condition& start, const Condition& end) {
  System system(mesh);
  const auto n = static_cast<Eigen::Index>(mesh.size());
  system.end_row(start, 0, 1, 0);
  system.end_row(end, n - 1, n - 2, n - 2);
  return system.solve();
}

Eigen::MatrixXd dense_velocities(const Mesh& mesh, const Condition& start, Tail tail) {
  System system(mesh);
  const auto n = static_cast<Eigen::Index>(mesh.size());
  system.end_row(start, 0, 1, 0);
  if (tail == Tail::natural) system.end_row({ConditionKind::natural, {}}, n - 1, n - 2, n - 2);
  if (tail == Tail::rest) system.end_row({ConditionKind::rest, {}}, n - 1, n - 2, n - 2);
  if (tail == Tail::parabolic) {
    system.a(n - 1, n - 2) = 1;
    system.a(n - 1, n - 1) = 1;
    system.b.row(n - 1) = 2 * system.chord(n - 2);
  }
  if (tail == Tail::bessel) {
    system.a(n - 1, n - 1) = 1;
    system.b.row(n - 1) = system.chord(n - 2);
    if (n > 2) {
      const double h0 = system.h(n - 3);
      const double h1 = system.h(n - 2);
      // Derivative at the last node of Newton's interpolation polynomial through three nodes.
      const Eigen::RowVectorXd second = (system.chord(n - 2) - system.chord(n - 3)) / (h0 + h1);
      system.b.row(n - 1) = system.chord(n - 3) + second * ((h0 + h1) + h1);
    }
  }
  return system.solve();
}

}  // namespace splinecast::testing
