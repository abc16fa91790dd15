#pragma once

#include "apps/replay/player.hpp"
#include "ipc/layout/header.hpp"

namespace splinecast::apps {

/// The lead of a live replay of a recording, on a board with this header: options.lead if it
/// is set, else the result of advised_lead(). Unless `quiet`, reports on standard error why an
/// advised lead differs from the default, or that the settle lag needs more than the given lead.
[[nodiscard]] Time choose_lead(const Survey& survey, const ReplayOptions& options,
                               const ipc::RegionHeader& board);

}  // namespace splinecast::apps
