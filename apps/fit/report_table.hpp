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

/// What the tables of a report say of one dimension of a derivative of a curve.
struct ReportRow {
  Extremes extremes;
  Extremum step;  ///< the jump at a knot that is largest by size; 0 at the first without one
};

/// What they say of a curve.
struct ReportTable {
  std::vector<ReportRow> rows;     ///< [dimension][derivative]
  std::vector<Extremum> distance;  ///< per dimension, largest from a waypoint
};

/// Measures a curve. Waypoints outside its time are not looked at. The steps of a quaternion are
/// those of what readers see, at unit length.
[[nodiscard]] ReportTable table_of(const PiecewisePolynomial& curve, const Waypoints& waypoints,
                                   std::span<const Dimension> kinds);

}  // namespace splinecast::apps
