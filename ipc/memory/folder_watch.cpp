#include "ipc/memory/folder_watch.hpp"

#include <sys/stat.h>

#include <chrono>
#include <ctime>
#include <string>

#include "ipc/memory/names.hpp"

namespace splinecast::ipc {
namespace {

/// A change within this time after another one may get the same modification time: file times on
/// Linux have the resolution of the kernel's tick, which is at most 10 ms.
constexpr Time kStampStep = std::chrono::milliseconds(20);

Time to_time(const timespec& time) noexcept {
  return std::chrono::seconds(time.tv_sec) + std::chrono::nanoseconds(time.tv_nsec);
}

}  // namespace

bool FolderWatch::has_changed() noexcept {
  static const std::string folder(kSharedMemoryFolder);
  timespec now{};
  clock_gettime(CLOCK_REALTIME, &now);  // before stat: a change after stat is never missed
  struct stat status {};
  if (stat(folder.c_str(), &status) != 0) return true;
  const Time modified = to_time(status.st_mtim);
  const bool is_same = modified == modified_ && !was_fresh_;
  modified_ = modified;
  was_fresh_ = to_time(now) - modified < kStampStep;
  return !is_same;
}

}  // namespace splinecast::ipc
