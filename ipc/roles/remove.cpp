#include <unistd.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "ipc/layout/check.hpp"
#include "ipc/layout/common_control.hpp"
#include "ipc/mapping/checked_region.hpp"
#include "ipc/mapping/owner_lock.hpp"
#include "ipc/memory/futex.hpp"
#include "ipc/requests/record.hpp"
#include "ipc/requests/stoppers.hpp"
#include "splinecast/errors.hpp"
#include "splinecast/streams.hpp"

namespace splinecast {
namespace ipc {
namespace {

/// A file under a region's name that this process may remove.
struct Removable {
  RegionKind kind;
  std::optional<Region> region{};  ///< empty: not a valid region, so that no process waits on it
  std::size_t control = 0;         ///< offset of its control lines
};

template <typename Layout>
Removable as_removable(RegionKind kind, CheckedRegion<Layout> opened) {
  return {.kind = kind, .region = std::move(opened.region), .control = opened.layout.control};
}

bool is_request(RegionKind kind) noexcept {
  return kind == RegionKind::commander || kind == RegionKind::stopper;
}

/// Whether a file's header and size are those of a region.
bool describes_region(const RegionFile& file, RegionKind kind) {
  if (!file.header) return false;
  try {
    if (kind == RegionKind::waypoints) checked_ring_layout(*file.header, file.bytes);
    if (kind == RegionKind::spline) checked_board_layout(*file.header, file.bytes);
    if (is_request(kind)) checked_request_layout(*file.header, kind, file.bytes);
    return true;
  } catch (const BadRegion&) {
    return false;
  }
}

Removable removable(const std::string& stream, RegionKind kind, const Trust& trust) {
  const RegionFile file = look_at_region(stream, kind, trust);
  if (file.is_own && !describes_region(file, kind)) return {.kind = kind};
  switch (kind) {
    case RegionKind::waypoints:
      return as_removable(kind, open_ring(stream, true, trust));
    case RegionKind::spline:
      return as_removable(kind, open_board(stream, true, trust));
    case RegionKind::commander:
    case RegionKind::stopper:
      break;
  }
  return as_removable(kind, open_request(stream, kind, true, trust));
}

/// Marks a region as retired, and wakes the processes that wait on it.
void retire(const Removable& file) noexcept {
  if (!file.region) return;
  const auto words = words_at(file.region->bytes(), file.control, kRetired + 1);
  store(words[kRetired], 1, std::memory_order_release);
  wake_all(words[0]);  // the word that its readers wait on
}

/// Removes the regions of these kinds under a stream's name, or under that of a law's commander.
void remove_regions(const std::string& stream, std::span<const RegionKind> kinds,
                    const Trust& trust) {
  const bool exists = std::ranges::any_of(kinds, [&](RegionKind kind) {
    return region_exists(stream, kind) || std::filesystem::exists(lock_path(stream, kind));
  });
  if (!exists) throw NoSuchStream("there is no stream '" + stream + "'");
  std::vector<OwnerLock> locks;
  std::vector<Removable> files;
  try {
    for (const RegionKind kind : kinds) locks.emplace_back(stream, kind);
    // Checks all files before it changes any.
    for (const RegionKind kind : kinds) {
      if (region_exists(stream, kind)) files.push_back(removable(stream, kind, trust));
    }
  } catch (const StreamError&) {
    for (OwnerLock& lock : locks) lock.remove_unused_file();
    throw;
  }
  for (const Removable& file : files) {
    retire(file);
    unlink_region(stream, file.kind);
    unlink((region_path(stream, file.kind) + ".new").c_str());  // of a solver that was killed
  }
  for (OwnerLock& lock : locks) lock.remove_file();
}

/// Whether the process of a stopper has ended and its request is withdrawn.
bool is_released(const std::string& region, const Trust& trust) {
  if (is_owned(region, RegionKind::stopper)) return false;
  const auto opened = open_request(region, RegionKind::stopper, false, trust);
  const auto control = words_at(opened.region.bytes(), opened.layout.control, kSeparationWords);
  std::array<Word, kStopperRecordWords> words{};
  const RecordCopy copy = copy_record(control, words);
  const auto request = copy.is_whole ? stop_request_of(words) : std::nullopt;
  return copy.is_unwritten() || (request && !request->is_latched);
}

/// Removes the regions of stoppers that do not hold the stream: the others stay in force. Returns
/// whether there was one.
bool remove_released_stoppers(const std::string& stream, const Trust& trust) {
  bool has_removed = false;
  for (const std::string& stopper : requester_names(stream, RegionKind::stopper)) {
    const std::string region = stopper_stream(stream, stopper);
    try {
      constexpr std::array kOfStopper{RegionKind::stopper};
      if (!is_released(region, trust)) continue;
      remove_regions(region, kOfStopper, trust);
      has_removed = true;
    } catch (const StreamError&) {
      continue;  // one that cannot be read, or is not this user's, may hold the stream
    }
  }
  return has_removed;
}

}  // namespace
}  // namespace ipc

void remove_stream(const std::string& stream, const Trust& trust) {
  const std::vector<std::string> commanders =
      ipc::requester_names(stream, ipc::RegionKind::commander);
  for (const std::string& commander : commanders) {
    if (!ipc::is_owned(ipc::commander_stream(stream, commander), ipc::RegionKind::commander))
      continue;
    throw StreamBusy("time law '" + stream + "' has a living commander '" + commander + "'");
  }
  constexpr std::array kOfStream{ipc::RegionKind::waypoints, ipc::RegionKind::spline};
  // With layout version 6 a commander had a waypoints region.
  constexpr std::array kOfCommander{ipc::RegionKind::commander, ipc::RegionKind::waypoints};
  const bool had_stopper = ipc::remove_released_stoppers(stream, trust);
  // A law that has not begun has only the regions of its commanders.
  try {
    ipc::remove_regions(stream, kOfStream, trust);
  } catch (const NoSuchStream&) {
    if (commanders.empty() && !had_stopper) throw;
  }
  for (const std::string& commander : commanders) {
    ipc::remove_regions(ipc::commander_stream(stream, commander), kOfCommander, trust);
  }
}

}  // namespace splinecast
