#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "apps/recordings/gaps.hpp"
#include "apps/tables/waypoints.hpp"
#include "splinecast/piecewise_polynomial.hpp"

/// A table with gaps, in pieces.
namespace splinecast::apps {

/// The gaps between the rows of a table, and the rows that follow them.
struct TableGaps {
  Gaps gaps{};
  std::vector<std::size_t> starts{};  ///< index of the first row of each piece after the first one
};

/// Finds the gaps of a table whose times increase. Throws InputError for the first one with
/// GapPolicy::refuse.
[[nodiscard]] TableGaps find_gaps(const WaypointTable& table, const GapOptions& options);

/// A part of a table, with `size` rows from row `first` on.
[[nodiscard]] WaypointTable part_of(const WaypointTable& table, std::size_t first,
                                    std::size_t size);

/// Joins the curves of the pieces: where a curve ends, an order-6 segment from rest to rest leads
/// to the beginning of the next one. A curve may be the hold of a single waypoint. Each curve must
/// be at rest where it is joined.
[[nodiscard]] PiecewisePolynomial join(const std::vector<PiecewisePolynomial>& curves);

}  // namespace splinecast::apps
