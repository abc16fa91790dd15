#pragma once

#include <string>

#include "apps/tables/waypoints.hpp"
#include "ipc/roles/inspect.hpp"

namespace splinecast::apps {

/// The waypoints that the ring of a stream still holds, in order, as if a file had been read whose
/// lines are the items' numbers; without those that a replacement withdrew. Reads as any passive
/// observer does and changes nothing. A name has its unit behind it in brackets, where the stream
/// gives one. Throws NoSuchStream or BadRegion as ipc::open_ring does.
[[nodiscard]] WaypointTable read_stream_rows(const std::string& stream, const Trust& trust);

/// Says so if the least depth of a running live stream is less than its settle lag needs; empty if
/// it is not, or if that cannot be told. Reads the stream's ring.
[[nodiscard]] std::string depth_warning(const ipc::StreamInfo& info, const Trust& trust);

}  // namespace splinecast::apps
