#include "ipc/mapping/checked_region.hpp"

#include <unistd.h>

#include <utility>

#include "ipc/layout/check.hpp"
#include "ipc/mapping/owner_lock.hpp"
#include "splinecast/clock.hpp"
#include "splinecast/errors.hpp"

namespace splinecast::ipc {
namespace {

void store_header_word(std::span<std::byte> region, std::size_t word, Word value,
                       std::memory_order order) noexcept {
  store(words_at(region, word * sizeof(Word), 1)[0], value, order);
}

template <typename Layout>
CheckedRegion<Layout> open_checked(std::string_view stream, RegionKind kind, bool writable,
                                   const Trust& trust, const auto& check) {
  Region region = Region::open(stream, kind, writable, trust);
  // A second name of the file (hard link) has its own lock file, which does not protect this
  // region.
  if (writable && is_region_locked(region.descriptor())) {
    throw StreamBusy(region_path(stream, kind) + " has a living " + std::string(owner_role(kind)));
  }
  const RegionHeader header = copy_header(region.bytes());
  try {
    const Layout layout = check(header, region.bytes().size());
    return {.region = std::move(region), .header = header, .layout = layout};
  } catch (const BadRegion& error) {
    throw BadRegion(region_path(stream, kind) + ": " + error.what());
  }
}

}  // namespace

CheckedRegion<RingLayout> open_ring(std::string_view stream, bool writable, const Trust& trust) {
  return open_checked<RingLayout>(stream, RegionKind::waypoints, writable, trust,
                                  checked_ring_layout);
}

CheckedRegion<BoardLayout> open_board(std::string_view stream, bool writable, const Trust& trust) {
  return open_checked<BoardLayout>(stream, RegionKind::spline, writable, trust,
                                   checked_board_layout);
}

CheckedRegion<RequestLayout> open_request(std::string_view stream, RegionKind kind, bool writable,
                                          const Trust& trust) {
  const auto check = [kind](const RegionHeader& header, std::size_t bytes) {
    return checked_request_layout(header, kind, bytes);
  };
  return open_checked<RequestLayout>(stream, kind, writable, trust, check);
}

void require_same_clock(const RegionHeader& header, const std::string& stream) {
  const auto clock = static_cast<StreamClock>(header.clock);
  if (!is_live(clock) || header.time_namespace == time_namespace()) return;
  throw BadRegion("stream '" + stream + "' runs on the clock of time namespace " +
                  std::to_string(header.time_namespace) + ", this process on that of " +
                  std::to_string(time_namespace()));
}

void enter_owner(std::span<std::byte> region, const RegionHeader& before) noexcept {
  const auto pid = static_cast<Word>(getpid());
  const Word since = to_word(MonotonicClock().now());
  store_header_word(region, kOwnerPid, pid, std::memory_order_relaxed);
  store_header_word(region, kOwnerSince, since, std::memory_order_relaxed);
  store_header_word(region, kEpoch, before.epoch + 1, std::memory_order_release);
}

}  // namespace splinecast::ipc
