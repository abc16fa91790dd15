#pragma once

#include <string>

#include "apps/tables/waypoints.hpp"
#include "ipc/roles/inspect.hpp"

namespace splinecast::apps {

/// The waypoints that the ring of a stream still holds, in order, as a table whose lines are the
/// item numbers; without those that a replacement withdrew. Reads as any passive observer does and
/// changes nothing. A name includes the unit in brackets, if the stream has one. Throws
/// NoSuchStream or BadRegion as ipc::open_ring does.
[[nodiscard]] WaypointTable read_stream_rows(const std::string& stream, const Trust& trust);

/// A warning if the least depth of a running live stream is less than its settle lag needs; empty
/// if it is not, or if this is unknown. Reads the stream's ring.
[[nodiscard]] std::string depth_warning(const ipc::StreamInfo& info, const Trust& trust);

}  // namespace splinecast::apps
