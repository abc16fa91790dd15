#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <set>
#include <string>
#include <utility>

#include "ipc/mapping/owner_lock.hpp"
#include "ipc/mapping/region.hpp"
#include "ipc/memory/names.hpp"
#include "ipc/sweep/many_streams.hpp"

namespace splinecast::ipc {

void StreamSweep::poll() {
  if (regions_.version() != seen_ || must_list_again_) {
    must_list_again_ = true;
    list_found_streams();
    seen_ = regions_.version();
    must_list_again_ = false;
  }
  note_ends_of_motion();
  retry_given_up();
  if (to_attach_.empty()) check_elsewhere();
  if (to_attach_.empty()) retry_postponed();
  if (is_any_unheld_) hold_regions();
}

/// Lists the streams to attach to, and drops streams that were found by a pattern and no longer
/// exist.
void StreamSweep::list_found_streams() {
  to_attach_.clear();
  given_up_.clear();
  std::set<std::string> existing = regions_.streams();
  // The ring of a law is made by its solver, once there is a commander.
  for (const auto& [law, commanders] : regions_.commanders().names()) existing.insert(law);
  for (const std::string& stream : existing) {
    if (is_wanted(stream)) members_.try_emplace(stream);
  }
  std::erase_if(members_, [&](const auto& entry) {
    const auto& [stream, member] = entry;
    const bool exists = existing.contains(stream);
    if (member.state == State::solved || exists || member.is_named) return false;
    notify(SweepNews::gone, stream, nullptr, {});
    return true;
  });
  for (auto& [stream, member] : members_) {
    const bool exists = existing.contains(stream);
    if (!exists && !member.is_named) continue;
    if (member.state == State::given_up) given_up_.push_back(stream);
    if (is_to_be_tried(member)) to_attach_.push_back(stream);
  }
  std::ranges::reverse(to_attach_);
}

bool StreamSweep::is_wanted(const std::string& stream) const {
  return std::ranges::any_of(patterns_,
                             [&](const std::string& pattern) { return matches(pattern, stream); });
}

bool StreamSweep::is_to_be_tried(const Member& member) noexcept {
  return member.state == State::unowned || member.state == State::waiting ||
         member.state == State::no_descriptors;
}

StreamSweep::Files StreamSweep::files_of(const std::string& stream) {
  const auto status_of = [](const std::string& path) {
    struct stat status {};
    if (lstat(path.c_str(), &status) != 0) status = {};
    return status;
  };
  const auto lock = status_of(lock_path(stream, RegionKind::spline));
  return {status_of(region_path(stream, RegionKind::waypoints)).st_ino,
          status_of(region_path(stream, RegionKind::spline)).st_ino,
          lock.st_uid != geteuid() ? lock.st_ino : 0};
}

/// Finds streams whose files have been replaced since they were given up: they are new streams, and
/// are reported as such. At most kTries in one call: any user can make thousands of such files.
void StreamSweep::retry_given_up() {
  for (std::size_t checked = 0; checked < kTries && !given_up_.empty(); ++checked) {
    const std::string stream = std::move(given_up_.back());
    given_up_.pop_back();
    const auto found = members_.find(stream);
    if (found == members_.end() || found->second.state != State::given_up) continue;
    if (files_of(stream) == found->second.files) continue;
    found->second.state = State::unowned;
    to_attach_.push_back(stream);
  }
}

/// Retries streams that waited for the end of an earlier motion: no event reports that end.
void StreamSweep::note_ends_of_motion() {
  std::erase_if(moving_, [&](const std::string& stream) {
    const auto found = members_.find(stream);
    if (found == members_.end() || !found->second.waiting) return true;
    const Time end = found->second.waiting->due();
    if (end > now_) return end == Time::max();
    to_attach_.push_back(stream);
    return true;
  });
}

/// Checks whether streams of other processes have lost their solver: at most kTries in one call.
void StreamSweep::check_elsewhere() {
  if (elsewhere_.empty()) {
    for (const auto& [stream, member] : members_) {
      if (member.state == State::elsewhere) elsewhere_.push_back(stream);
    }
  }
  for (std::size_t checked = 0; checked < kTries && !elsewhere_.empty(); ++checked) {
    const std::string stream = std::move(elsewhere_.back());
    elsewhere_.pop_back();
    const auto found = members_.find(stream);
    if (found == members_.end() || found->second.state != State::elsewhere) continue;
    if (is_owned(stream, RegionKind::spline)) continue;
    to_attach_.push_back(stream);
    checked = 0;
  }
}

/// Retries the next of the streams that lacked memory or descriptors.
void StreamSweep::retry_postponed() {
  if (now_ < next_retry_) return;
  next_retry_ = now_ + kRetry;
  const auto is_postponed = [](const auto& entry) {
    return entry.second.state == State::postponed;
  };
  auto next = std::find_if(members_.upper_bound(last_retried_), members_.end(), is_postponed);
  if (next == members_.end()) next = std::ranges::find_if(members_, is_postponed);
  if (next == members_.end()) return;
  to_attach_.push_back(next->first);
  last_retried_ = next->first;
}

}  // namespace splinecast::ipc
