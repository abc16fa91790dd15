#include "ipc/owned/request.hpp"

#include <utility>

#include "ipc/layout/header.hpp"
#include "ipc/layout/request_control.hpp"
#include "ipc/mapping/checked_region.hpp"
#include "ipc/options/stream.hpp"
#include "splinecast/clock.hpp"
#include "splinecast/errors.hpp"

namespace splinecast::ipc {
namespace {

OwnedRequest make_request(const std::string& name, RegionKind kind, const RegionAccess& access) {
  RegionHeader header = blank_header(random_id(), true);
  header.kind = static_cast<std::uint64_t>(kind);
  header.clock = static_cast<std::uint64_t>(StreamClock::monotonic);
  header.region_bytes = kBodyOffset;
  Region region = Region::create(header.region_bytes, access);
  write_header(region.bytes(), header);
  enter_owner(region.bytes(), header);
  OwnedRequest request(std::move(region), header);
  if (!request.region.link(name, kind)) {
    throw BadRegion(region_path(name, kind) + " was created by another process at the same time");
  }
  return request;
}

OwnedRequest continue_request(const std::string& name, RegionKind kind, const Trust& trust) {
  auto [region, header, layout] = open_request(name, kind, true, trust);
  OwnedRequest request(std::move(region), header);
  require_same_clock(header, name);
  enter_owner(request.region.bytes(), header);
  return request;
}

}  // namespace

OwnedRequest::OwnedRequest(Region mapped, const RegionHeader& header)
    : region(std::move(mapped)),
      lock(region.descriptor()),
      id(header.stream_id),
      control(words_at(region.bytes(), header.control, kSeparationWords)) {}

OwnedRequest own_request(const std::string& name, RegionKind kind, const RegionAccess& access,
                         const Trust& trust, OwnerLock& lock) {
  try {
    return region_exists(name, kind) ? continue_request(name, kind, trust)
                                     : make_request(name, kind, access);
  } catch (...) {
    lock.remove_unused_file();
    throw;
  }
}

}  // namespace splinecast::ipc
