#pragma once

#include <sys/resource.h>
#include <sys/types.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "apps/machine/environment.hpp"
#include "splinecast/time.hpp"

namespace splinecast::apps {

/// Size of a file system, in bytes.
struct Room {
  std::uint64_t total;
  std::uint64_t free;
};

/// The facts that a machine is judged by: texts of files (empty for a missing file and for one
/// listed in `unread`) and values that the kernel reports to this process. Tests can construct the
/// facts of any machine.
struct MachineFacts {
  Environment environment;
  std::map<std::string, std::string> unread{};  ///< files that cannot be read, and why
  std::string mounts;                           ///< /proc/self/mounts
  std::optional<Room> room{};                   ///< of /dev/shm, for this user
  bool may_write_shared = true;                 ///< whether this user may create files in /dev/shm
  rlim_t lockable = RLIM_INFINITY;              ///< RLIMIT_MEMLOCK, bytes
  rlim_t priority = 0;                          ///< RLIMIT_RTPRIO
  std::string status;                           ///< /proc/self/status: capabilities
  uid_t user = 0;                               ///< effective
  std::string logind;  ///< logind.conf and its drop-ins; the last value of a key counts
  bool runs_systemd = false;
  bool in_container = false;         ///< the file system has a container's marker file
  std::uint64_t pid_namespace = 0;   ///< inode; 0: unknown
  std::uint64_t time_namespace = 0;  ///< inode; 0: unknown, or a kernel without time namespaces
  std::string clock_offsets;         ///< /proc/self/timens_offsets
  std::string shared_huge_pages;     ///< …/transparent_hugepage/shmem_enabled
  std::string cpu_times;             ///< /proc/stat
  Time clock_cost{};                 ///< of one reading of CLOCK_MONOTONIC, mean
};

/// Reads the facts, with files under `root`. Takes less than a millisecond. Never throws for a file
/// that is missing.
[[nodiscard]] MachineFacts read_machine(const std::filesystem::path& root = "/");

}  // namespace splinecast::apps
