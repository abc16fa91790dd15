#include "ipc/owned/commander.hpp"

#include <utility>

#include "ipc/layout/commander_control.hpp"
#include "ipc/layout/header.hpp"
#include "ipc/mapping/checked_region.hpp"
#include "ipc/options/stream.hpp"
#include "splinecast/clock.hpp"
#include "splinecast/errors.hpp"

namespace splinecast::ipc {
namespace {

OwnedCommander make_commander(const std::string& name, const RegionAccess& access) {
  RegionHeader header = blank_header(random_id(), true);
  header.kind = static_cast<std::uint64_t>(RegionKind::commander);
  header.clock = static_cast<std::uint64_t>(StreamClock::monotonic);
  header.region_bytes = kBodyOffset;
  Region region = Region::create(header.region_bytes, access);
  write_header(region.bytes(), header);
  enter_owner(region.bytes(), header);
  OwnedCommander commander(std::move(region), header);
  if (!commander.region.link(name, RegionKind::commander)) {
    throw BadRegion(region_path(name, RegionKind::commander) +
                    " was created by another process at the same time");
  }
  return commander;
}

OwnedCommander continue_commander(const std::string& name, const Trust& trust) {
  auto [region, header, layout] = open_commander(name, true, trust);
  OwnedCommander commander(std::move(region), header);
  require_same_clock(header, name);
  enter_owner(commander.region.bytes(), header);
  return commander;
}

}  // namespace

OwnedCommander::OwnedCommander(Region mapped, const RegionHeader& header)
    : region(std::move(mapped)),
      lock(region.descriptor()),
      id(header.stream_id),
      control(words_at(region.bytes(), header.control, kCommanderControlWords)) {}

OwnedCommander own_commander(const std::string& name, const RegionAccess& access,
                             const Trust& trust, OwnerLock& lock) {
  try {
    return region_exists(name, RegionKind::commander) ? continue_commander(name, trust)
                                                      : make_commander(name, access);
  } catch (...) {
    lock.remove_unused_file();
    throw;
  }
}

}  // namespace splinecast::ipc
