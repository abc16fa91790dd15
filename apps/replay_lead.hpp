#pragma once

#include "replay.hpp"
#include "splinecast/ipc/layout.hpp"

namespace splinecast::apps {

/// The lead of a live replay of a prepared table, on a board with this header: the one that is
/// asked for, else what advised_lead says. Says on standard error, unless `quiet`, why it is not
/// the default, or that what is asked for is less than the settle lag needs.
[[nodiscard]] core::Time choose_lead(const WaypointTable& table, const ReplayOptions& options,
                                     const ipc::RegionHeader& board);

}  // namespace splinecast::apps
