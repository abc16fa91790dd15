#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "splinecast/calculus.hpp"
#include "splinecast/dimension_kind.hpp"
#include "splinecast/waypoint.hpp"

namespace splinecast::apps {

/// Derivatives that a report shows: position, velocity, acceleration, jerk.
inline constexpr std::size_t kDerivatives = 4;

/// One row of a report's tables: one derivative of one dimension of a curve.
struct ReportRow {
  Extremes extremes;
  Extremum step;  ///< largest jump at a knot, by magnitude; 0 at the first break if no knot has one
};

/// The table of one curve.
struct ReportTable {
  std::vector<ReportRow> rows;     ///< [dimension][derivative]
  std::vector<Extremum> distance;  ///< per dimension, largest distance from a waypoint
};

/// Measures a curve. Ignores waypoints outside its time range. Steps of a quaternion are measured
/// at unit length, as readers see it.
[[nodiscard]] ReportTable table_of(const PiecewisePolynomial& curve, const Waypoints& waypoints,
                                   std::span<const Dimension> kinds);

}  // namespace splinecast::apps
