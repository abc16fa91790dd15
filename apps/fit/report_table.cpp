#include "apps/fit/report_table.hpp"

#include <cmath>

#include "core/polynomial/segment.hpp"

namespace splinecast::apps {
namespace {

/// Keeps the value of larger magnitude; on a tie the present one.
void consider(Extremum& largest, Time time, double value) {
  if (std::abs(value) > std::abs(largest.value)) largest = {.time = time, .value = value};
}

/// The kinds with periodic dimensions made linear: a wrapped position steps by a period.
DimensionKinds only_quaternions(std::span<const Dimension> kinds) {
  std::vector<Dimension> all(kinds.begin(), kinds.end());
  for (Dimension& dimension : all) {
    if (dimension.kind == DimensionKind::periodic) dimension = {};
  }
  return DimensionKinds(all);
}

void measure_steps(const PiecewisePolynomial& curve, const DimensionKinds& quaternions,
                   ReportTable& table) {
  const std::size_t dimensions = curve.dimensions();
  State left(dimensions);
  State right(dimensions);
  const auto evaluate = [&](std::size_t segment, double u, State& out) {
    core::evaluate(curve.order_of(segment), curve.coefficients(segment), u, out.ref());
    quaternions.normalise(out.ref());
  };
  for (std::size_t i = 1; i < curve.segments(); ++i) {
    evaluate(i - 1, curve.seconds(i - 1), left);
    evaluate(i, 0, right);
    for (std::size_t r = 0; r < kDerivatives; ++r) {
      for (std::size_t d = 0; d < dimensions; ++d) {
        const std::size_t at = r * dimensions + d;
        consider(table.rows[d * kDerivatives + r].step, curve.left_of(i),
                 right.values()[at] - left.values()[at]);
      }
    }
  }
}

void measure_distances(const PiecewisePolynomial& curve, const Waypoints& waypoints,
                       ReportTable& table) {
  std::vector<double> position(curve.dimensions());
  for (std::size_t i = 0; i < waypoints.size(); ++i) {
    const Waypoint waypoint = waypoints[i];
    if (waypoint.time < curve.breaks().front() || waypoint.time > curve.breaks().back()) continue;
    curve.derivative(waypoint.time, 0, position);
    for (std::size_t d = 0; d < position.size(); ++d) {
      consider(table.distance[d], waypoint.time, std::abs(position[d] - waypoint.position[d]));
    }
  }
}

}  // namespace

ReportTable table_of(const PiecewisePolynomial& curve, const Waypoints& waypoints,
                     std::span<const Dimension> kinds) {
  const Extremum none{.time = curve.breaks().front(), .value = 0};
  ReportTable table;
  for (std::size_t d = 0; d < curve.dimensions(); ++d) {
    for (std::size_t r = 0; r < kDerivatives; ++r) {
      table.rows.push_back({.extremes = extremes(curve, d, static_cast<int>(r)), .step = none});
    }
  }
  table.distance.assign(curve.dimensions(), none);
  measure_steps(curve, only_quaternions(kinds), table);
  measure_distances(curve, waypoints, table);
  return table;
}

}  // namespace splinecast::apps
