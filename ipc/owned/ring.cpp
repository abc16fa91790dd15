#include "ipc/owned/ring.hpp"

#include <bit>
#include <optional>
#include <utility>

#include "ipc/mapping/checked_region.hpp"
#include "ipc/memory/futex.hpp"
#include "ipc/options/stream.hpp"
#include "ipc/ring/reader.hpp"
#include "splinecast/errors.hpp"

namespace splinecast::ipc {
namespace {

OwnedRing make_ring(const std::string& stream, const ProducerOptions& options,
                    const Describe& describe) {
  RegionHeader header = make_header(options, random_id());
  header.kind = static_cast<std::uint64_t>(RegionKind::waypoints);
  header.capacity = std::bit_ceil(options.capacity);
  if (describe) describe(header);
  const auto layout = RingLayout::of(header.dimensions, header.capacity, header.control);
  header.stride = layout.stride;
  header.region_bytes = layout.bytes;
  Region region = Region::create(layout.bytes, options.access);
  write_header(region.bytes(), header);
  enter_owner(region.bytes(), header);
  OwnedRing ring(std::move(region), header, layout);
  if (!ring.region.link(stream, RegionKind::waypoints)) {
    throw BadRegion(region_path(stream, RegionKind::waypoints) +
                    " was created by another process at the same time");
  }
  return ring;
}

/// Takes over the existing ring of that name if it can be continued. Retires a finished one, and
/// removes its name. Returns nothing if there is no ring to continue.
std::optional<OwnedRing> continue_ring(const std::string& stream, const ProducerOptions& options) {
  if (!region_exists(stream, RegionKind::waypoints)) return std::nullopt;
  auto [region, header, layout] = open_ring(stream, true, options.trust);
  OwnedRing ring(std::move(region), header, layout);
  const WaypointRingReader past(ring.region.bytes(), layout);
  if (past.retired() || ring.writer.finished()) {
    ring.writer.retire();
    wake_all(ring.writer.written_word());
    unlink_region(stream, RegionKind::waypoints);
    return std::nullopt;
  }
  require_same_clock(header, stream);
  require_same_options(stream, header, options);
  enter_owner(ring.region.bytes(), header);
  return ring;
}

}  // namespace

OwnedRing::OwnedRing(Region mapped, const RegionHeader& described, const RingLayout& of_it)
    : region(std::move(mapped)),
      lock(region.descriptor()),
      header(described),
      layout(of_it),
      writer(region.bytes(), of_it, interval_range(described)) {}

OwnedRing own_ring(const std::string& stream, const ProducerOptions& options, OwnerLock& lock,
                   const Describe& describe) {
  try {
    auto continued = continue_ring(stream, options);
    return continued ? std::move(*continued) : make_ring(stream, options, describe);
  } catch (...) {
    lock.remove_unused_file();
    throw;
  }
}

}  // namespace splinecast::ipc
