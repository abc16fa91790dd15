#include "splinecast/ipc/stream_files.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>

#include "splinecast/ipc/errors.hpp"
#include "splinecast/ipc/futex.hpp"
#include "splinecast/ipc/owner_lock.hpp"
#include "splinecast/ipc/waypoint_ring.hpp"

namespace splinecast::ipc {
namespace {

constexpr int kHeadTries = 16;

void inspect_waypoints(StreamInfo& info, const Trust& trust) {
  const Region region = Region::open(info.stream, RegionKind::waypoints, false, trust);
  info.waypoints = copy_header(region.bytes());
  const auto layout = checked_ring_layout(*info.waypoints, region.bytes().size());
  const WaypointRingReader ring(region.bytes(), layout);
  info.appended = ring.head();
  for (std::size_t i = 0; i < info.refused_by_producer.size(); ++i) {
    info.refused_by_producer[i] = ring.refused(static_cast<AppendStatus>(i));
  }
}

void inspect_spline(StreamInfo& info, const Trust& trust) {
  const Region region = Region::open(info.stream, RegionKind::spline, false, trust);
  info.spline = copy_header(region.bytes());
  const auto layout = checked_board_layout(*info.spline, region.bytes().size());
  const SegmentBoardReader board(region.bytes(), layout);
  for (int attempt = 0; attempt < kHeadTries; ++attempt) {
    const Word r = board.revision();
    if (r == 0 || board.copy_head(r, info.head)) break;
  }
  // The oldest half of the ring may be written again while it is read.
  const Word kept = std::min<Word>(info.head.refused, kRefusalsKept / 2);
  for (Word i = info.head.refused - kept; i < info.head.refused; ++i) {
    info.refusals.push_back(board.refusal(i));
  }
}

/// Says that a region is of no more use to whoever has it mapped. A region that is no region of
/// ours says nothing.
void retire_region(const std::string& stream, RegionKind kind, const Trust& trust) {
  const Region region = Region::open(stream, kind, true, trust);
  std::size_t control = 0;
  try {
    const RegionHeader header = copy_header(region.bytes());
    control = kind == RegionKind::waypoints
                  ? checked_ring_layout(header, region.bytes().size()).control
                  : checked_board_layout(header, region.bytes().size()).control;
  } catch (const BadRegion&) {
    return;
  }
  const auto words = words_at(region.bytes(), control, kRetired + 1);
  store(words[kRetired], 1, std::memory_order_release);
  wake_all(words[0]);  // head or revision: what its readers wait on
}

}  // namespace

bool owner_lives(std::string_view stream, RegionKind kind) {
  const int opened =
      open(region_path(stream, kind).c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
  if (opened < 0) return false;
  const bool lives = is_region_locked(opened);
  close(opened);
  return lives;
}

StreamInfo inspect(const std::string& stream, const Trust& trust) {
  StreamInfo info;
  info.stream = stream;
  const bool has_waypoints = region_exists(stream, RegionKind::waypoints);
  const bool has_spline = region_exists(stream, RegionKind::spline);
  if (!has_waypoints && !has_spline) {
    throw NoSuchStream("there is no stream '" + stream + "'");
  }
  info.producer_alive = owner_lives(stream, RegionKind::waypoints);
  info.solver_alive = owner_lives(stream, RegionKind::spline);
  if (has_waypoints) inspect_waypoints(info, trust);
  if (has_spline) inspect_spline(info, trust);
  return info;
}

void remove_stream(const std::string& stream, const Trust& trust) {
  constexpr std::array kKinds{RegionKind::waypoints, RegionKind::spline};
  const bool stands = std::ranges::any_of(kKinds, [&](RegionKind kind) {
    return region_exists(stream, kind) || std::filesystem::exists(lock_path(stream, kind));
  });
  if (!stands) throw NoSuchStream("there is no stream '" + stream + "'");
  OwnerLock producer_lock(stream, RegionKind::waypoints);
  std::optional<OwnerLock> solver_lock;
  try {
    solver_lock.emplace(stream, RegionKind::spline);
  } catch (const StreamError&) {
    producer_lock.remove_file_without_region();
    throw;
  }
  for (const RegionKind kind : kKinds) {
    if (!region_exists(stream, kind)) continue;
    retire_region(stream, kind, trust);
    unlink_region(stream, kind);
  }
  producer_lock.remove_file();
  solver_lock->remove_file();
}

}  // namespace splinecast::ipc
