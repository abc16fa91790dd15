#pragma once

#include "apps/recordings/late_rows.hpp"
#include "apps/recordings/refused_rows.hpp"
#include "apps/tables/waypoints.hpp"
#include "splinecast/options.hpp"

/// Preparation of a recording before it is sent.
namespace splinecast::apps {

/// Keeps the rows from `from` on, counted from the first row's time, and for `duration` from there;
/// unset: no bound. Throws InputError if no row is left.
void select_rows(WaypointTable& table, std::optional<Time> from, std::optional<Time> duration);

/// Makes a recording `rate` times as fast: divides the times since the first one by `rate`,
/// multiplies velocities by it and accelerations by its square. Throws InputError if the result is
/// longer than kLongestTime.
void change_rate(WaypointTable& table, double rate);

/// The median interval between rows that are in order; 10 ms if there are no such rows.
[[nodiscard]] Time median_interval(const WaypointTable& table);

/// Removes the rows that the ring would refuse and adds each to `skipped`, with a message that has
/// line and value; without `skipped`, throws InputError for the first one. Throws if no row is
/// left. Counts rows whose time is not after that of the previous row, and applies `policy` to
/// them: `pass` leaves them out; `shift` leaves out copies of the previous row and moves any other
/// row, with all rows after it, to one median interval after the previous row.
LateRows drop_unfit_rows(WaypointTable& table, const IngestLimits& limits, LatePolicy policy,
                         RefusedRows* skipped);

}  // namespace splinecast::apps
