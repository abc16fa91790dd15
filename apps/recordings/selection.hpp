#pragma once

#include "apps/recordings/late_rows.hpp"
#include "apps/recordings/refused_rows.hpp"
#include "apps/tables/waypoints.hpp"
#include "splinecast/options.hpp"

/// What is done to a recording before it is sent.
namespace splinecast::apps {

/// Keeps the rows from `from` on, for `duration`, as far as these are set; both count from the
/// first row's time. Throws InputError if none is left.
void select_rows(WaypointTable& table, std::optional<Time> from, std::optional<Time> duration);

/// Plays `rate` times as fast: divides times about the first one by it, multiplies velocities by it
/// and accelerations by its square.
void change_rate(WaypointTable& table, double rate);

/// The median interval between rows that are in order; 10 ms if there are none.
[[nodiscard]] Time median_interval(const WaypointTable& table);

/// Drops the rows that the ring would refuse and notes each in `skipped`, with a message that names
/// line and value; without `skipped`, throws InputError for the first one. Throws if none is left.
/// Rows whose time is not after that of the row before are treated as `policy` says, and counted:
/// `pass` leaves them out; `shift` drops copies of the row before and moves any other one, with all
/// rows behind it, to a median interval behind that row.
LateRows drop_unfit_rows(WaypointTable& table, const IngestLimits& limits, LatePolicy policy,
                         RefusedRows* skipped);

}  // namespace splinecast::apps
