#include "apps/machine/checks.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "tests/fixtures/processes/process.hpp"

/// The findings of `doctor` from the facts of a machine.
namespace splinecast::apps {
namespace {

Environment good_environment() {
  Environment environment;
  environment.isolated = "2-3";
  environment.governor = "performance";
  environment.preemption = "PREEMPT_RT";
  environment.clock = "tsc";
  environment.rt_runtime = "-1";
  environment.rt_period = "1000000";
  return environment;
}

/// A machine without any finding.
MachineFacts good_machine() {
  return {.environment = good_environment(),
          .mounts = "proc /proc proc rw 0 0\ntmpfs /dev/shm tmpfs rw,nosuid,nodev 0 0\n",
          .room = Room{.total = std::uint64_t{1} << 30U, .free = std::uint64_t{1} << 29U},
          .may_write_shared = true,
          .lockable = std::uint64_t{1} << 26U,
          .priority = 80,
          .status = "Name:\tx\nCapEff:\t0000000000000000\n",
          .user = 1000,
          .logind = "[Login]\n#RemoveIPC=yes\nRemoveIPC=no\n",
          .runs_systemd = true,
          .in_container = false,
          .pid_namespace = 4026531836,
          .time_namespace = 4026531834,
          .clock_offsets = "monotonic 0 0\nboottime 0 0\n",
          .shared_huge_pages = "always within_size advise [never] deny force\n",
          .cpu_times = "cpu  100 0 100 800 0 0 0 1 0 0\ncpu0 1 2 3\n",
          .clock_cost = Time(20)};
}

constexpr std::size_t kNeeded = std::size_t{1} << 24U;

TEST(Doctor, ReportsOnlyOkForAGoodMachine) {
  for (const Finding& finding : check_machine(good_machine(), kNeeded, kNeeded)) {
    EXPECT_EQ(finding.verdict, Verdict::ok) << finding.check << ": " << finding.means;
    EXPECT_FALSE(finding.means.empty()) << finding.check;
    EXPECT_TRUE(finding.fix.empty()) << finding.check;
  }
}

/// A change of one fact, and the expected finding.
struct Case {
  const char* check;
  Verdict verdict;
  std::string means;
  std::function<void(MachineFacts&)> change;
};

/// The limits of a machine that `doctor` reports.
const std::vector<Case> kLimits{
    {"/dev/shm", Verdict::problem, "not mounted", [](auto& m) { m.mounts = ""; }},
    {"/dev/shm", Verdict::problem, "is ext4",
     [](auto& m) { m.mounts = "/dev/sda1 /dev/shm ext4 rw 0 0\n"; }},
    {"/dev/shm", Verdict::problem, "read-only",
     [](auto& m) { m.mounts += "tmpfs /dev/shm tmpfs nosuid,ro 0 0\n"; }},
    {"/dev/shm", Verdict::problem, "may not create files",
     [](auto& m) { m.may_write_shared = false; }},
    {"room in /dev/shm", Verdict::problem, "needs about 16.0 MiB",
     [](auto& m) { m.room->free = kNeeded - 1; }},
    {"room in /dev/shm", Verdict::note, "64.0 MiB in total",
     [](auto& m) { m.room = Room{.total = 64 << 20U, .free = 64 << 20U}; }},
    {"locked memory", Verdict::note, "RLIMIT_MEMLOCK is 0.1 MiB",
     [](auto& m) { m.lockable = 64 << 10U; }},
    {"real-time priority", Verdict::note, "RLIMIT_RTPRIO is 0", [](auto& m) { m.priority = 0; }},
    {"RemoveIPC", Verdict::note, "is on", [](auto& m) { m.logind = ""; }},
    {"RemoveIPC", Verdict::note, "is on",
     [](auto& m) { m.logind += "[Login]\n RemoveIPC = yes\n"; }},
    {"container", Verdict::note, "share its /dev/shm", [](auto& m) { m.in_container = true; }},
    {"container", Verdict::note, "separate PID namespace",
     [](auto& m) { m.pid_namespace = 4026532000; }},
    {"time namespace", Verdict::note, "clock 1000.000000005 s ahead",
     [](auto& m) {
       m.time_namespace = 4026532001;
       m.clock_offsets = "monotonic        1000         5\nboottime 0 0\n";
     }},
    {"clock", Verdict::note, "hpet, 20 ns per reading: each reading of it is a system call",
     [](auto& m) { m.environment.clock = "hpet"; }},
    {"cpu governor", Verdict::note, "powersave",
     [](auto& m) { m.environment.governor = "powersave"; }},
    {"isolated cpus", Verdict::note, "none", [](auto& m) { m.environment.isolated = ""; }},
    {"kernel preemption", Verdict::note, "PREEMPT_DYNAMIC",
     [](auto& m) { m.environment.preemption = "PREEMPT_DYNAMIC"; }},
    {"real-time throttling", Verdict::note, "stopped for 50 ms of each 1000000 us",
     [](auto& m) { m.environment.rt_runtime = "950000"; }},
    {"huge pages", Verdict::note, "always for shared memory",
     [](auto& m) { m.shared_huge_pages = "[always] within_size advise never\n"; }},
    {"hypervisor", Verdict::note, "KVM; 10.00 % of the CPUs' time stolen",
     [](auto& m) {
       m.environment.hypervisor = "KVM";
       m.cpu_times = "cpu  100 0 100 700 0 0 0 100 0 0\n";
     }},
};

TEST(Doctor, FindsEachLimitIndependently) {
  for (const Case& one : kLimits) {
    MachineFacts machine = good_machine();
    one.change(machine);
    for (const Finding& finding : check_machine(machine, kNeeded, kNeeded)) {
      if (finding.check != one.check) {
        EXPECT_EQ(finding.verdict, Verdict::ok) << one.means << " changed " << finding.check;
        continue;
      }
      EXPECT_EQ(finding.verdict, one.verdict) << finding.means;
      EXPECT_NE(finding.means.find(one.means), std::string::npos) << finding.means;
      EXPECT_FALSE(finding.fix.empty()) << finding.means;
    }
  }
}

/// Makes a file unreadable.
std::function<void(MachineFacts&)> hide(const char* file) {
  return [file](MachineFacts& m) { m.unread[file] = "Permission denied"; };
}

/// Facts that cannot be read, and the reason.
const std::vector<Case> kHidden{
    {"/dev/shm",
     {},
     "/proc/self/mounts: Permission denied",
     [](auto& m) {
       m.mounts = "";
       hide("/proc/self/mounts")(m);
     }},
    {"room in /dev/shm", {}, "does not report", [](auto& m) { m.room.reset(); }},
    {"locked memory",
     {},
     "/proc/self/status: Permission denied",
     [](auto& m) {
       m.lockable = 0;
       m.status = "";
       hide("/proc/self/status")(m);
     }},
    {"real-time priority",
     {},
     "/proc/self/status: Permission denied",
     [](auto& m) {
       m.priority = 0;
       m.status = "";
       hide("/proc/self/status")(m);
     }},
    {"RemoveIPC",
     {},
     "/etc/systemd/logind.conf: Permission denied",
     hide("/etc/systemd/logind.conf")},
    {"clock",
     {},
     "current_clocksource: Permission denied",
     [](auto& m) {
       m.environment.clock = "";
       hide("/sys/devices/system/clocksource/clocksource0/current_clocksource")(m);
     }},
    {"cpu governor",
     {},
     "in a virtual machine",
     [](auto& m) {
       m.environment.governor = "";
       m.environment.hypervisor = "KVM";
     }},
    {"isolated cpus",
     {},
     "isolated: Permission denied",
     [](auto& m) {
       m.environment.isolated = "";
       hide("/sys/devices/system/cpu/isolated")(m);
     }},
    {"kernel preemption",
     {},
     "/proc/sys/kernel/version: Permission denied",
     [](auto& m) {
       m.environment.preemption = "";
       hide("/proc/sys/kernel/version")(m);
     }},
    {"real-time throttling",
     {},
     "sched_rt_runtime_us: Permission denied",
     [](auto& m) {
       m.environment.rt_runtime = "";
       hide("/proc/sys/kernel/sched_rt_runtime_us")(m);
     }},
    {"huge pages",
     {},
     "shmem_enabled: Permission denied",
     [](auto& m) {
       m.shared_huge_pages = "";
       hide("/sys/kernel/mm/transparent_hugepage/shmem_enabled")(m);
     }},
    {"hypervisor",
     {},
     "/proc/stat: Permission denied",
     [](auto& m) {
       m.cpu_times = "";
       hide("/proc/stat")(m);
     }},
};

/// The check of an unreadable fact is not `ok`, and no other check changes.
TEST(Doctor, ReportsUnknownWithTheReasonForUnreadableFacts) {
  for (const Case& one : kHidden) {
    MachineFacts machine = good_machine();
    one.change(machine);
    for (const Finding& finding : check_machine(machine, kNeeded, kNeeded)) {
      const bool is_it = finding.check == one.check;
      EXPECT_EQ(finding.verdict, is_it ? Verdict::unknown : Verdict::ok)
          << finding.check << ": " << finding.means;
      if (is_it) {
        EXPECT_NE(finding.means.find(one.means), std::string::npos) << finding.means;
      }
    }
  }
}

TEST(Doctor, InAContainerTheHostsSystemdIsUnknown) {
  MachineFacts machine = good_machine();
  machine.runs_systemd = false;
  EXPECT_EQ(check_remove_ipc(machine).verdict, Verdict::ok);
  machine.in_container = true;
  EXPECT_EQ(check_remove_ipc(machine).verdict, Verdict::unknown);
  machine.in_container = false;
  machine.pid_namespace = 0;
  machine.time_namespace = 0;
  EXPECT_EQ(check_container(machine).verdict, Verdict::unknown);
  EXPECT_EQ(check_time_namespace(machine).verdict, Verdict::unknown);
}

/// No file can be read: no check that depends on files is `ok`.
TEST(Doctor, ReportsUnknownWithoutProcAndSys) {
  const testing::TestFolder root;
  const MachineFacts facts = read_machine(root.path(""));
  EXPECT_EQ(facts.unread.at("/proc/stat"), "No such file or directory");
  for (const auto check :
       {check_clock, check_governor, check_isolated_cpus, check_preemption, check_throttling,
        check_huge_pages, check_steal, check_container, check_time_namespace}) {
    const Finding finding = check(facts);
    EXPECT_EQ(finding.verdict, Verdict::unknown) << finding.check << ": " << finding.means;
    EXPECT_FALSE(finding.means.empty());
  }
  EXPECT_EQ(check_room(facts, kNeeded).verdict, Verdict::unknown);
  std::filesystem::create_directories(root.path("proc/stat"));  // can be opened but not read
  EXPECT_EQ(read_machine(root.path("")).unread.at("/proc/stat"), "Is a directory");
}

TEST(Doctor, ComparesTheRoomWithOneMoreStreamAndLockedMemoryWithAllStreams) {
  MachineFacts machine = good_machine();
  machine.room->free = 2 * kNeeded;
  machine.lockable = 2 * kNeeded;
  const auto verdict_of = [&](const std::string& check) {
    const auto findings = check_machine(machine, kNeeded, 3 * kNeeded);
    return std::ranges::find(findings, check, &Finding::check)->verdict;
  };
  EXPECT_EQ(verdict_of("room in /dev/shm"), Verdict::ok);
  EXPECT_EQ(verdict_of("locked memory"), Verdict::note);
}

TEST(Doctor, PrivilegesAndMissingFeaturesAreNotReportedAsLimits) {
  const std::vector<std::function<void(MachineFacts&)>> changes{
      [](auto& m) {  // CAP_IPC_LOCK and CAP_SYS_NICE
        m.lockable = 0;
        m.priority = 0;
        m.status = "CapEff:\t0000000000804000\n";
      },
      [](auto& m) { m.lockable = RLIM_INFINITY; },
      [](auto& m) {
        m.logind = "";
        m.runs_systemd = false;
      },
      [](auto& m) {
        m.logind = "";
        m.user = 999;
      },
      [](auto& m) { m.time_namespace = 0; },
      [](auto& m) { m.environment.clock = "kvm-clock"; },
      [](auto& m) { m.environment.governor = ""; },
      [](auto& m) { m.shared_huge_pages = ""; },
      [](auto& m) { m.cpu_times = ""; }};
  for (const auto& change : changes) {
    MachineFacts machine = good_machine();
    change(machine);
    for (const Finding& finding : check_machine(machine, kNeeded, kNeeded)) {
      EXPECT_EQ(finding.verdict, Verdict::ok) << finding.check << ": " << finding.means;
    }
  }
}

TEST(Doctor, ReadsFactsFromTheFilesOfAnyMachine) {
  const testing::TestFolder root;
  const auto put = [&](const std::string& file, const std::string& text) {
    std::filesystem::create_directories(std::filesystem::path(root.path(file)).parent_path());
    (void)root.write(file, text);
  };
  put("proc/self/mounts", "tmpfs /dev/shm tmpfs rw 0 0\n");
  put("proc/self/status", "CapEff:\t0000000000004000\n");
  put("proc/stat", "cpu 1 2 3\n");
  put("etc/systemd/logind.conf", "RemoveIPC=no\n");
  put("etc/systemd/logind.conf.d/20-b.conf", "RemoveIPC=off\n");
  put("usr/lib/systemd/logind.conf.d/10-a.conf", "RemoveIPC=yes\n");
  put("usr/lib/systemd/logind.conf.d/20-b.conf", "RemoveIPC=hidden\n");
  put("run/systemd/system/x", "");
  put("run/.containerenv", "");
  put("sys/kernel/mm/transparent_hugepage/shmem_enabled", "always [never]\n");
  const MachineFacts facts = read_machine(root.path(""));
  EXPECT_EQ(facts.mounts, "tmpfs /dev/shm tmpfs rw 0 0\n");
  EXPECT_EQ(facts.status, "CapEff:\t0000000000004000\n");
  EXPECT_EQ(facts.cpu_times, "cpu 1 2 3\n");
  EXPECT_EQ(facts.logind, "RemoveIPC=no\n\nRemoveIPC=yes\n\nRemoveIPC=off\n");
  EXPECT_TRUE(facts.runs_systemd);
  EXPECT_TRUE(facts.in_container);
  EXPECT_EQ(facts.shared_huge_pages, "always [never]\n");
  EXPECT_FALSE(facts.room);  // the machine has no dev/shm
  EXPECT_FALSE(facts.may_write_shared);
  EXPECT_EQ(facts.time_namespace, 0U);
  EXPECT_EQ(facts.user, geteuid());
}

}  // namespace
}  // namespace splinecast::apps
