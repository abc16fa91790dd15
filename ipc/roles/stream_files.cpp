#include "ipc/roles/stream_files.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <utility>

#include "ipc/mapping/checked_region.hpp"
#include "ipc/mapping/owner_lock.hpp"
#include "ipc/memory/futex.hpp"
#include "ipc/ring/waypoint_ring.hpp"
#include "ipc/solve/shown_motion.hpp"
#include "splinecast/errors.hpp"

namespace splinecast::ipc {
namespace {

constexpr int kHeadTries = 16;

void inspect_waypoints(StreamInfo& info, const Trust& trust) {
  const auto [region, header, layout] = open_ring(info.stream, false, trust);
  info.waypoints = header;
  const WaypointRingReader ring(region.bytes(), layout);
  info.appended = ring.head();
  for (std::size_t i = 0; i < info.refused_by_producer.size(); ++i) {
    info.refused_by_producer[i] = ring.refused(static_cast<AppendStatus>(i));
  }
}

void inspect_spline(StreamInfo& info, const Trust& trust) {
  const auto [region, header, layout] = open_board(info.stream, false, trust);
  info.spline = header;
  const KnotBoardReader board(region.bytes(), layout);
  for (int attempt = 0; attempt < kHeadTries; ++attempt) {
    const Look look = board.look();
    if (look.revision == 0 || board.copy_head(look, info.head)) break;
  }
  info.step_times = board.step_times();
  if (live_options(header)) {
    ShownMotion shown(board);
    shown.restore(board, info.head, core::Time::max());
    shown.look(core::Time(header.stop_time));
    info.shown = shown.limits();
  }
  info.refusals.resize(kRefusalsKept);
  info.refusals.resize(board.copy_refusals(info.head, 0, info.refusals));
  const Word excesses = info.head.exceeding;
  for (Word i = excesses - std::min<Word>(excesses, kExcessesKept); i < excesses; ++i) {
    if (const auto excess = board.excess(info.head, i)) info.excesses.push_back(*excess);
  }
}

/// A file under a region's name that this process may remove.
struct Removable {
  RegionKind kind;
  std::optional<Region> region{};  ///< none: it cannot be used as a region, so nobody waits for it
  std::size_t control = 0;         ///< where its control lines are
};

template <typename Layout>
Removable as_removable(RegionKind kind, CheckedRegion<Layout> opened) {
  return {.kind = kind, .region = std::move(opened.region), .control = opened.layout.control};
}

/// Whether a file's header and size are those of a region.
bool describes_region(const RegionFile& file, RegionKind kind) {
  if (!file.header) return false;
  try {
    if (kind == RegionKind::waypoints) checked_ring_layout(*file.header, file.bytes);
    if (kind == RegionKind::spline) checked_board_layout(*file.header, file.bytes);
    return true;
  } catch (const BadRegion&) {
    return false;
  }
}

Removable removable(const std::string& stream, RegionKind kind, const Trust& trust) {
  const RegionFile file = look_at_region(stream, kind, trust);
  if (file.is_own && !describes_region(file, kind)) return {.kind = kind};
  return kind == RegionKind::waypoints ? as_removable(kind, open_ring(stream, true, trust))
                                       : as_removable(kind, open_board(stream, true, trust));
}

/// Says that a region is of no more use to whoever has it mapped.
void retire(const Removable& file) noexcept {
  if (!file.region) return;
  const auto words = words_at(file.region->bytes(), file.control, kRetired + 1);
  store(words[kRetired], 1, std::memory_order_release);
  wake_all(words[0]);  // head or revision: what its readers wait on
}

}  // namespace

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
  std::vector<Removable> files;
  try {
    solver_lock.emplace(stream, RegionKind::spline);
    // All are looked at before any is touched.
    for (const RegionKind kind : kKinds) {
      if (region_exists(stream, kind)) files.push_back(removable(stream, kind, trust));
    }
  } catch (const StreamError&) {
    if (solver_lock) solver_lock->remove_litter();
    producer_lock.remove_litter();
    throw;
  }
  for (const Removable& file : files) {
    retire(file);
    unlink_region(stream, file.kind);
  }
  producer_lock.remove_file();
  solver_lock->remove_file();
}

}  // namespace splinecast::ipc
