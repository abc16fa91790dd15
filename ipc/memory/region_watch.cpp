#include "ipc/memory/region_watch.hpp"

#include <sys/inotify.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <utility>

#include "splinecast/clock.hpp"

namespace splinecast::ipc {
namespace {

constexpr std::uint32_t kComes = IN_CREATE | IN_MOVED_TO;
constexpr std::uint32_t kGoes = IN_DELETE | IN_MOVED_FROM;

/// How often the folder's modification time is compared with what is known: with events, to notice
/// that none arrive; without, for each change.
constexpr Time kCheckEvery = std::chrono::seconds(1);
constexpr Time kReadEvery = std::chrono::milliseconds(20);
/// Limits the share of the time that reading the folder takes, for any number of files.
constexpr int kShare = 20;

}  // namespace

RegionWatch::RegionWatch() : events_(OwnedDescriptor::event_queue()) {
  const std::string folder(kSharedMemoryFolder);
  const bool is_watched = events_.get() >= 0 && inotify_add_watch(events_.get(), folder.c_str(),
                                                                  kComes | kGoes | IN_ONLYDIR) >= 0;
  if (!is_watched) events_ = {};
}

void RegionWatch::poll() {
  take_events();
  const MonotonicClock clock;
  const Time now = clock.now();
  if (now >= next_check_) {
    const bool has_changed = folder_.has_changed();
    is_complete_ = is_complete_ && (has_event_ || !has_changed);
    has_event_ = false;
    next_check_ = now + (events_.get() >= 0 ? kCheckEvery : kReadEvery);
  }
  if (is_complete_) return;
  read_folder();
  next_check_ = std::max(next_check_, now + kShare * (clock.now() - now));
}

/// Takes the events that are in the queue, at most kReads buffers of them: the next call takes the
/// others.
void RegionWatch::take_events() {
  constexpr int kReads = 64;
  alignas(inotify_event) std::array<char, 4096> buffer{};
  bool is_complete = std::exchange(is_complete_, false);  // so it stays if an allocation fails
  for (int i = 0; i < kReads && events_.get() >= 0; ++i) {
    const ssize_t bytes = ::read(events_.get(), buffer.data(), buffer.size());
    if (bytes <= 0) break;
    for (std::size_t at = 0; at < static_cast<std::size_t>(bytes);) {
      inotify_event event{};
      std::memcpy(&event, buffer.data() + at, sizeof event);
      const char* const file = buffer.data() + at + sizeof event;
      at += sizeof event + event.len;
      const bool has_lost = (event.mask & (IN_Q_OVERFLOW | IN_IGNORED)) != 0;
      is_complete = is_complete && !has_lost;
      if ((event.mask & IN_IGNORED) != 0) events_ = {};  // the folder itself is gone
      has_event_ = true;
      const auto region = event.len > 0 ? region_in(file) : std::nullopt;
      if (region) note(*region, (event.mask & kComes) != 0);
    }
  }
  is_complete_ = is_complete;
}

/// A file of a region or of a lock has come or gone.
void RegionWatch::note(const RegionFileName& region, bool comes) {
  ++version_;
  if (region.is_lock) return;
  if (region.kind == RegionKind::waypoints && is_stream_name(region.stream)) {
    if (comes) streams_.emplace(region.stream);
    if (!comes) streams_.erase(std::string(region.stream));
  }
  const auto [of, name] = split_requester(region.stream);
  if (name.empty()) return;
  const bool is_commander = region.kind == RegionKind::commander;
  if (is_commander) commanders_.note(std::string(of), std::string(name), comes);
  if (region.kind == RegionKind::stopper) stoppers_.note(std::string(of), std::string(name), comes);
}

void RegionWatch::read_folder() {
  ++version_;
  streams_.clear();
  commanders_.clear();
  stoppers_.clear();
  for_each_region([&](const RegionFileName& region) { note(region, true); });
  is_complete_ = true;
}

const std::set<std::string>& Requesters::names_of(const std::string& of) const noexcept {
  static const std::set<std::string> kNone;
  const auto found = names_.find(of);
  return found != names_.end() ? found->second : kNone;
}

void Requesters::note(const std::string& of, std::string name, bool comes) {
  ++version_;
  auto& names = names_[of];
  if (comes) names.insert(std::move(name));
  if (!comes) names.erase(name);
  if (names.empty()) names_.erase(of);
}

void Requesters::clear() noexcept {
  ++version_;
  names_.clear();
}

}  // namespace splinecast::ipc
