#include "apps/machine/checks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <sstream>
#include <string>
#include <string_view>

#include "apps/files/numbers.hpp"
#include "apps/machine/unread.hpp"

namespace splinecast::apps {
namespace {

// From linux/capability.h, whose names are macros of another package.
constexpr unsigned kCapabilityIpcLock = 14;
constexpr unsigned kCapabilitySysNice = 23;
/// Inodes of the namespaces that the kernel boots with (linux/proc_ns.h).
constexpr std::uint64_t kFirstPidNamespace = 0xEFFFFFFC;
constexpr std::uint64_t kFirstTimeNamespace = 0xEFFFFFFA;
/// Users below this are system users: logind does not remove their shared memory.
constexpr uid_t kFirstOrdinaryUser = 1000;
/// The default size of /dev/shm in a container.
constexpr std::uint64_t kContainersRoom = std::uint64_t{64} << 20U;

std::string mebibytes(double bytes) { return fmt::format("{:.1f} MiB", bytes / (1 << 20)); }

bool has_capability(const MachineFacts& facts, unsigned number) {
  std::istringstream lines(facts.status);
  for (std::string line; std::getline(lines, line);) {
    constexpr std::string_view kField = "CapEff:";
    if (!line.starts_with(kField)) continue;
    std::uint64_t set = 0;
    std::istringstream(line.substr(kField.size())) >> std::hex >> set;
    return (set >> number & 1U) != 0;
  }
  return false;
}

/// Type and options of the mount on /dev/shm: the last mount hides those before it.
struct Mount {
  std::string type;
  std::string options;
};

Mount shared_memory_mount(const std::string& mounts) {
  Mount found;
  std::istringstream lines(mounts);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream fields(line);
    std::string device;
    std::string point;
    Mount mount;
    fields >> device >> point >> mount.type >> mount.options;
    if (point == "/dev/shm") found = mount;
  }
  return found;
}

/// The effective value of a key in an INI file: the last one.
std::string setting(const std::string& text, std::string_view key) {
  std::string value;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t equals = line.find('=');
    if (equals == std::string::npos) continue;
    const std::string_view view(line);
    if (without_blanks(view.substr(0, equals)) != key) continue;
    value = without_blanks(view.substr(equals + 1));
  }
  return value;
}

constexpr const char* kMounts = "/proc/self/mounts";
constexpr const char* kStatus = "/proc/self/status";
constexpr const char* kLogind = "/etc/systemd/logind.conf";

bool is_contained(const MachineFacts& facts) {
  return facts.in_container ||
         (facts.pid_namespace != 0 && facts.pid_namespace != kFirstPidNamespace);
}

}  // namespace

Finding check_shared_memory(const MachineFacts& facts) {
  const Mount mount = shared_memory_mount(facts.mounts);
  const std::string check = "/dev/shm";
  const std::string why = unread(facts, {kMounts});
  if (!why.empty() && facts.may_write_shared) return unknown(check, why);
  if (why.empty() && mount.type != "tmpfs") {
    return {.check = check,
            .verdict = Verdict::problem,
            .means = mount.type.empty() ? "is not mounted: there is no shared memory"
                                        : fmt::format("is {}, not memory (tmpfs)", mount.type),
            .fix = "mount -t tmpfs -o mode=1777,size=50% tmpfs /dev/shm"};
  }
  if (fmt::format(",{},", mount.options).find(",ro,") != std::string::npos) {
    return {.check = check,
            .verdict = Verdict::problem,
            .means = "is mounted read-only: no stream can be created",
            .fix = "mount -o remount,rw /dev/shm"};
  }
  if (!facts.may_write_shared) {
    return {.check = check,
            .verdict = Verdict::problem,
            .means = "this user may not create files there: no stream can be created",
            .fix = "chmod 1777 /dev/shm"};
  }
  return {.check = check, .means = "is memory (tmpfs), and this user may create streams there"};
}

Finding check_room(const MachineFacts& facts, std::size_t another) {
  const std::string check = "room in /dev/shm";
  if (!facts.room) return unknown(check, "the kernel does not report it (statvfs)");
  const Room room = *facts.room;
  const std::string means =
      fmt::format("{} in total, {} free", mebibytes(static_cast<double>(room.total)),
                  mebibytes(static_cast<double>(room.free)));
  if (room.free < another) {
    return {.check = check,
            .verdict = Verdict::problem,
            .means = means + fmt::format("; another stream needs about {}",
                                         mebibytes(static_cast<double>(another))),
            .fix =
                "remove streams (splinecast rm), or mount -o remount,size=1g /dev/shm; in a "
                "container: --shm-size=1g"};
  }
  if (room.total <= kContainersRoom) {
    return {.check = check,
            .verdict = Verdict::note,
            .means = means + "; a few streams use it up",
            .fix = "mount -o remount,size=1g /dev/shm; in a container: --shm-size=1g"};
  }
  return {.check = check, .means = means};
}

Finding check_locked_memory(const MachineFacts& facts, std::size_t mapped) {
  const std::string check = "locked memory";
  if (facts.lockable == RLIM_INFINITY || has_capability(facts, kCapabilityIpcLock)) {
    return {.check = check, .means = "no limit: no page of a stream is swapped out"};
  }
  const std::string means = fmt::format("RLIMIT_MEMLOCK is {}, the streams need {}",
                                        mebibytes(static_cast<double>(facts.lockable)),
                                        mebibytes(static_cast<double>(mapped)));
  if (facts.lockable >= mapped) return {.check = check, .means = means};
  // CAP_IPC_LOCK would suffice.
  if (const auto why = unread(facts, {kStatus}); !why.empty()) {
    return unknown(check, means + "; " + why);
  }
  return {.check = check,
          .verdict = Verdict::note,
          .means = means + ": everything works, but their pages may be swapped out",
          .fix =
              "`USER - memlock unlimited` in /etc/security/limits.d/splinecast.conf; for a "
              "service: LimitMEMLOCK=infinity"};
}

Finding check_priority(const MachineFacts& facts) {
  const std::string check = "real-time priority";
  if (has_capability(facts, kCapabilitySysNice)) {
    return {.check = check, .means = "this user may use SCHED_FIFO (CAP_SYS_NICE)"};
  }
  if (facts.priority > 0) {
    return {.check = check,
            .means = fmt::format("this user may use SCHED_FIFO up to {} (RLIMIT_RTPRIO)",
                                 facts.priority)};
  }
  // CAP_SYS_NICE would suffice.
  if (const auto why = unread(facts, {kStatus}); !why.empty()) {
    return unknown(check, "RLIMIT_RTPRIO is 0; " + why);
  }
  return {.check = check,
          .verdict = Verdict::note,
          .means = "RLIMIT_RTPRIO is 0: solver and readers share the CPUs with all other processes",
          .fix =
              "`USER - rtprio 80` in /etc/security/limits.d/splinecast.conf; for a service: "
              "LimitRTPRIO=80"};
}

Finding check_remove_ipc(const MachineFacts& facts) {
  const std::string check = "RemoveIPC";
  if (!facts.runs_systemd && is_contained(facts)) {
    return unknown(check, "the host of this container may run systemd");
  }
  if (!facts.runs_systemd) {
    return {.check = check, .means = "no systemd: a user's shared memory is not removed"};
  }
  if (facts.user < kFirstOrdinaryUser) {
    return {.check = check, .means = "does not apply to a system user"};
  }
  if (const auto why = unread(facts, {kLogind}); !why.empty()) return unknown(check, why);
  const std::string value = setting(facts.logind, "RemoveIPC");
  constexpr std::array<std::string_view, 5> kNo{"no", "false", "off", "0", "n"};
  if (std::ranges::find(kNo, value) != kNo.end()) {
    return {.check = check, .means = "is off: streams outlive the user's last session"};
  }
  return {.check = check,
          .verdict = Verdict::note,
          .means = "is on: systemd removes this user's streams when the last session ends",
          .fix =
              "RemoveIPC=no in /etc/systemd/logind.conf, then systemctl restart systemd-logind; "
              "or run the writers as a service of a system user"};
}

Finding check_container(const MachineFacts& facts) {
  const std::string check = "container";
  if (!facts.in_container && facts.pid_namespace == 0) {
    return unknown(check, "/proc/self/ns/pid cannot be read");
  }
  if (!facts.in_container && facts.pid_namespace == kFirstPidNamespace) {
    return {.check = check, .means = "none: all processes of this host see the same streams"};
  }
  return {
      .check = check,
      .verdict = Verdict::note,
      .means = facts.in_container ? "yes: only processes that share its /dev/shm see its streams"
                                  : "this is a separate PID namespace: the process ids in streams "
                                    "may have no meaning here",
      .fix =
          "start all containers with --ipc=host, or with --ipc=shareable and --ipc=container:NAME"};
}

Finding check_time_namespace(const MachineFacts& facts) {
  const std::string check = "time namespace";
  if (facts.time_namespace == 0 && facts.pid_namespace == 0) {
    return unknown(check, "/proc/self/ns/time cannot be read");
  }
  if (facts.time_namespace == 0 || facts.time_namespace == kFirstTimeNamespace) {
    return {.check = check, .means = "that of the host: all processes share its clock"};
  }
  std::istringstream offsets(facts.clock_offsets);
  std::string clock;
  std::int64_t seconds = 0;
  std::int64_t nanoseconds = 0;
  offsets >> clock >> seconds >> nanoseconds;
  return {.check = check,
          .verdict = Verdict::note,
          .means = fmt::format("a separate one, its clock {}.{:09} s ahead of the host's: live "
                               "streams from outside are refused",
                               seconds, nanoseconds),
          .fix = "run producer, solver and readers in one time namespace"};
}

std::vector<Finding> check_machine(const MachineFacts& facts, std::size_t another,
                                   std::size_t mapped) {
  return {
      check_shared_memory(facts),  check_room(facts, another), check_locked_memory(facts, mapped),
      check_priority(facts),       check_remove_ipc(facts),    check_container(facts),
      check_time_namespace(facts), check_clock(facts),         check_governor(facts),
      check_isolated_cpus(facts),  check_preemption(facts),    check_throttling(facts),
      check_huge_pages(facts),     check_steal(facts)};
}

}  // namespace splinecast::apps
