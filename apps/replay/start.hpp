#pragma once

#include <optional>

#include "apps/replay/player.hpp"
#include "apps/replay/sent_rows.hpp"
#include "ipc/layout/header.hpp"
#include "splinecast/producer.hpp"
#include "splinecast/time.hpp"
#include "splinecast/waypoint.hpp"

namespace splinecast::apps {

/// Starts a new live stream whose first row is `first` where `--start-from` says that the machine
/// is; without it, where the producer finds that it is. `board`: that of the solver. Returns by how
/// much the lead grows, for an entry from there to the first row. Throws InputError for values that
/// do not fit the stream, or if the start is refused.
[[nodiscard]] Time start_stream(Producer& producer, const std::optional<StartFrom>& where,
                                const Waypoint& first, const ipc::RegionHeader& board,
                                SentRows& rows);

/// The message for a first row that is not where the machine is.
[[nodiscard]] std::string elsewhere_message(Producer& producer, const Waypoint& first);

}  // namespace splinecast::apps
