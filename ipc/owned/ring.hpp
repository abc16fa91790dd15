#pragma once

#include <functional>
#include <string>

#include "ipc/layout/header.hpp"
#include "ipc/layout/waypoint_items.hpp"
#include "ipc/mapping/owner_lock.hpp"
#include "ipc/mapping/region.hpp"
#include "ipc/ring/writer.hpp"
#include "splinecast/options.hpp"

namespace splinecast::ipc {

/// A ring region of which this process is the writer, created or taken over.
struct OwnedRing {
  Region region;
  RegionLock lock;
  RegionHeader header;
  RingLayout layout;
  WaypointRingWriter writer;

  OwnedRing(Region mapped, const RegionHeader& described, const RingLayout& of_it);
};

/// Fills what a law's header has in addition to that of other streams: see RegionHeader.
using Describe = std::function<void(RegionHeader& header)>;

/// Takes over the ring of that name if it can be continued; else retires a finished one, and
/// creates a ring. `stream` is a stream's name or one of commander_stream(); `lock` is its lock,
/// whose unused file is removed on failure. Throws as the constructor of Producer does.
[[nodiscard]] OwnedRing own_ring(const std::string& stream, const ProducerOptions& options,
                                 OwnerLock& lock, const Describe& describe = {});

}  // namespace splinecast::ipc
