#pragma once

#include "apps/replay/player.hpp"
#include "ipc/layout/header.hpp"

namespace splinecast::apps {

/// The lead of a live replay of a prepared table, on a board with this header: the given one, else
/// that of advised_lead. Unless `quiet`, reports on standard error why it differs from the default,
/// or that the settle lag needs more than the given one.
[[nodiscard]] Time choose_lead(const WaypointTable& table, const ReplayOptions& options,
                               const ipc::RegionHeader& board);

}  // namespace splinecast::apps
