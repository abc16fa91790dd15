#include "apps/machine/facts.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <map>
#include <sstream>
#include <system_error>

#include "splinecast/clock.hpp"

namespace splinecast::apps {
namespace {

namespace fs = std::filesystem;

std::string text_of(const fs::path& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

/// 0 if the file can be read, else the error number.
int error_of_reading(const fs::path& file) {
  const int descriptor = open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  char first = 0;
  const bool is_read = descriptor >= 0 && read(descriptor, &first, 1) >= 0;
  const int error = errno;
  if (descriptor >= 0) close(descriptor);
  return is_read ? 0 : error;
}

/// The files that the checks and the environment need but that cannot be read, with the reason.
/// logind.conf may be missing. `shmem_enabled` may be missing if its folder exists.
std::map<std::string, std::string> unread_files(const fs::path& root) {
  std::map<std::string, std::string> unread;
  const auto look = [&](const char* file, bool may_lack) {
    const int error = error_of_reading(root / file);
    if (error == 0 || (may_lack && error == ENOENT)) return;
    unread[fs::path("/") / file] = std::generic_category().message(error);
  };
  for (const char* const file :
       {"proc/self/mounts", "proc/self/status", "proc/stat", "proc/cpuinfo",
        "proc/sys/kernel/version", "proc/sys/kernel/sched_rt_runtime_us",
        "proc/sys/kernel/sched_rt_period_us", "sys/devices/system/cpu/isolated",
        "sys/devices/system/clocksource/clocksource0/current_clocksource"}) {
    look(file, false);
  }
  std::error_code none;
  look("etc/systemd/logind.conf", true);
  look("sys/kernel/mm/transparent_hugepage/shmem_enabled",
       fs::exists(root / "sys/kernel/mm", none));
  return unread;
}

/// logind.conf, then its drop-ins by name; a drop-in in /etc hides those of the same name
/// elsewhere.
std::string logind_settings(const fs::path& root) {
  std::map<std::string, fs::path> drop_ins;
  for (const char* const folder : {"usr/lib/systemd", "run/systemd", "etc/systemd"}) {
    std::error_code none;
    for (const auto& entry : fs::directory_iterator(root / folder / "logind.conf.d", none)) {
      if (entry.path().extension() == ".conf") drop_ins[entry.path().filename()] = entry.path();
    }
  }
  std::string text = text_of(root / "etc/systemd/logind.conf");
  for (const auto& [name, path] : drop_ins) text.append("\n").append(text_of(path));
  return text;
}

std::optional<Room> room_of(const fs::path& folder) {
  struct statvfs status {};
  if (statvfs(folder.c_str(), &status) != 0) return std::nullopt;
  return Room{.total = std::uint64_t{status.f_blocks} * status.f_frsize,
              .free = std::uint64_t{status.f_bavail} * status.f_frsize};
}

rlim_t limit_of(__rlimit_resource resource) {
  struct rlimit limit {};
  return getrlimit(resource, &limit) == 0 ? limit.rlim_cur : 0;
}

std::uint64_t inode_of(const fs::path& file) {
  struct stat status {};
  return stat(file.c_str(), &status) == 0 ? status.st_ino : 0;
}

Time measure_clock() {
  constexpr int kReadings = 1000;
  const MonotonicClock clock;
  const Time begin = clock.now();
  for (int i = 1; i < kReadings; ++i) (void)clock.now();
  return (clock.now() - begin) / kReadings;
}

}  // namespace

MachineFacts read_machine(const fs::path& root) {
  const fs::path shared = root / "dev/shm";
  const fs::path self = root / "proc/self";
  return {
      .environment = read_environment(root),
      .unread = unread_files(root),
      .mounts = text_of(self / "mounts"),
      .room = room_of(shared),
      .may_write_shared = access(shared.c_str(), W_OK | X_OK) == 0,
      .lockable = limit_of(RLIMIT_MEMLOCK),
      .priority = limit_of(RLIMIT_RTPRIO),
      .status = text_of(self / "status"),
      .user = geteuid(),
      .logind = logind_settings(root),
      .runs_systemd = fs::exists(root / "run/systemd/system"),
      .in_container = fs::exists(root / ".dockerenv") || fs::exists(root / "run/.containerenv") ||
                      fs::exists(root / "run/systemd/container"),
      .pid_namespace = inode_of(self / "ns/pid"),
      .time_namespace = inode_of(self / "ns/time"),
      .clock_offsets = text_of(self / "timens_offsets"),
      .shared_huge_pages = text_of(root / "sys/kernel/mm/transparent_hugepage/shmem_enabled"),
      .cpu_times = text_of(root / "proc/stat"),
      .clock_cost = measure_clock(),
  };
}

}  // namespace splinecast::apps
