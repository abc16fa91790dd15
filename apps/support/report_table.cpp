#include "support/report_table.hpp"

#include <cmath>

namespace splinecast::apps {
namespace {

/// Keeps the larger one by size; on a tie the one that is there.
void consider(core::Extremum& largest, core::Time time, double value) {
  if (std::abs(value) > std::abs(largest.value)) largest = {.time = time, .value = value};
}

void measure_steps(const core::PiecewisePolynomial& curve, ReportTable& table) {
  std::vector<double> jump(curve.dimensions());
  for (std::size_t i = 1; i < curve.segments(); ++i) {
    for (std::size_t r = 0; r < kDerivatives; ++r) {
      curve.jump(i, static_cast<int>(r), jump);
      for (std::size_t d = 0; d < jump.size(); ++d) {
        consider(table.rows[d * kDerivatives + r].step, curve.left_of(i), jump[d]);
      }
    }
  }
}

void measure_distances(const core::PiecewisePolynomial& curve, const core::Waypoints& waypoints,
                       ReportTable& table) {
  std::vector<double> position(curve.dimensions());
  for (std::size_t i = 0; i < waypoints.size(); ++i) {
    const core::Waypoint waypoint = waypoints[i];
    if (waypoint.time < curve.breaks().front() || waypoint.time > curve.breaks().back()) continue;
    curve.derivative(waypoint.time, 0, position);
    for (std::size_t d = 0; d < position.size(); ++d) {
      consider(table.distance[d], waypoint.time, std::abs(position[d] - waypoint.position[d]));
    }
  }
}

}  // namespace

ReportTable table_of(const core::PiecewisePolynomial& curve, const core::Waypoints& waypoints) {
  const core::Extremum none{.time = curve.breaks().front(), .value = 0};
  ReportTable table;
  for (std::size_t d = 0; d < curve.dimensions(); ++d) {
    for (std::size_t r = 0; r < kDerivatives; ++r) {
      table.rows.push_back(
          {.extremes = core::extremes(curve, d, static_cast<int>(r)), .step = none});
    }
  }
  table.distance.assign(curve.dimensions(), none);
  measure_steps(curve, table);
  measure_distances(curve, waypoints, table);
  return table;
}

}  // namespace splinecast::apps
