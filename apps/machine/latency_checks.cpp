#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <sstream>
#include <string>
#include <string_view>

#include "apps/machine/checks.hpp"
#include "apps/machine/unread.hpp"

/// Checks of what affects latencies: the kernel, the CPUs and the hypervisor.
namespace splinecast::apps {
namespace {

/// Steal below this share of the CPUs' time is noise.
constexpr double kLeastSteal = 0.01;

constexpr const char* kStat = "/proc/stat";
constexpr const char* kCpuInfo = "/proc/cpuinfo";
constexpr const char* kVersion = "/proc/sys/kernel/version";
constexpr const char* kRuntime = "/proc/sys/kernel/sched_rt_runtime_us";
constexpr const char* kPeriod = "/proc/sys/kernel/sched_rt_period_us";
constexpr const char* kIsolated = "/sys/devices/system/cpu/isolated";
constexpr const char* kClockSource =
    "/sys/devices/system/clocksource/clocksource0/current_clocksource";
constexpr const char* kHugePages = "/sys/kernel/mm/transparent_hugepage/shmem_enabled";

/// The choice in brackets of a file such as `always [never]`.
std::string chosen(const std::string& text) {
  const std::size_t open = text.find('[');
  const std::size_t close = text.find(']', open);
  if (open == std::string::npos || close == std::string::npos) return {};
  return text.substr(open + 1, close - open - 1);
}

}  // namespace

Finding check_clock(const MachineFacts& facts) {
  const std::string check = "clock";
  const std::string& source = facts.environment.clock;
  const std::string means =
      fmt::format("{}, {} ns per reading", source.empty() ? std::string("unknown source") : source,
                  facts.clock_cost.count());
  // Clock sources that are read without a system call.
  constexpr std::array<std::string_view, 4> kFast{"tsc", "kvm-clock", "arch_sys_counter",
                                                  "hyperv_clocksource_tsc_page"};
  if (const auto why = unread(facts, {kClockSource}); !why.empty() || source.empty()) {
    return unknown(check, why.empty() ? means : means + "; " + why);
  }
  if (std::ranges::find(kFast, source) != kFast.end()) {
    return {.check = check, .means = means};
  }
  return {.check = check,
          .verdict = Verdict::note,
          .means = means + ": each reading of it is a system call",
          .fix =
              "find out why the kernel rejected tsc (dmesg | grep -i tsc); tsc=reliable on its "
              "command line, if the machine's tsc is reliable"};
}

Finding check_governor(const MachineFacts& facts) {
  const std::string& governor = facts.environment.governor;
  if (governor.empty()) {
    if (const auto why = unread(facts, {kIsolated}); !why.empty()) {
      return unknown("cpu governor", why);  // /sys/devices/system/cpu cannot be read
    }
    if (!facts.environment.hypervisor.empty()) {
      return unknown("cpu governor",
                     "the governor of the host is not visible in a virtual machine");
    }
  }
  if (governor.empty() || governor == "performance") {
    return {.check = "cpu governor",
            .means = governor.empty() ? "the kernel does not scale the CPUs' frequency" : governor};
  }
  return {.check = "cpu governor",
          .verdict = Verdict::note,
          .means = governor + ": a CPU that has slept starts at a low frequency",
          .fix = "cpupower frequency-set -g performance"};
}

Finding check_isolated_cpus(const MachineFacts& facts) {
  if (const auto why = unread(facts, {kIsolated}); !why.empty()) {
    return unknown("isolated cpus", why);
  }
  const std::string& isolated = facts.environment.isolated;
  if (!isolated.empty()) return {.check = "isolated cpus", .means = isolated};
  return {.check = "isolated cpus",
          .verdict = Verdict::note,
          .means = "none: any process may delay a controller",
          .fix =
              "isolcpus=LIST on the kernel's command line, and pin processes to these CPUs "
              "(taskset -c LIST)"};
}

Finding check_preemption(const MachineFacts& facts) {
  const std::string& preemption = facts.environment.preemption;
  if (preemption == "PREEMPT_RT") return {.check = "kernel preemption", .means = preemption};
  if (const auto why = unread(facts, {kVersion}); !why.empty() || preemption.empty()) {
    return unknown("kernel preemption", why.empty() ? "the kernel does not report it" : why);
  }
  return {.check = "kernel preemption",
          .verdict = Verdict::note,
          .means = preemption + ": the kernel may delay a real-time process for milliseconds",
          .fix = "apt-get install linux-image-rt-amd64"};
}

Finding check_throttling(const MachineFacts& facts) {
  const std::string check = "real-time throttling";
  const auto stopped = throttled_time(facts.environment);
  if (!stopped) {
    const auto why = unread(facts, {kRuntime, kPeriod});
    return unknown(check, why.empty() ? "the kernel does not report it" : why);
  }
  if (*stopped == Time::zero()) {
    return {.check = check, .means = "is off: a SCHED_FIFO process may take a whole CPU"};
  }
  return {.check = check,
          .verdict = Verdict::note,
          .means = fmt::format("a SCHED_FIFO process that spins is stopped for {:g} ms of each {} "
                               "us (sched_rt_runtime_us is {})",
                               to_seconds(*stopped) * 1e3, facts.environment.rt_period,
                               facts.environment.rt_runtime),
          .fix =
              "let it sleep; or sysctl -w kernel.sched_rt_runtime_us=-1, if no process can block a "
              "CPU"};
}

Finding check_huge_pages(const MachineFacts& facts) {
  if (const auto why = unread(facts, {kHugePages}); !why.empty()) {
    return unknown("huge pages", why);
  }
  const std::string choice = chosen(facts.shared_huge_pages);
  if (choice.empty() || choice == "never" || choice == "deny" || choice == "advise") {
    return {.check = "huge pages",
            .means = "shared memory has none: no page of a stream is moved into one"};
  }
  return {.check = "huge pages",
          .verdict = Verdict::note,
          .means = choice + " for shared memory: the kernel may stop a process to assemble them",
          .fix = "echo never > /sys/kernel/mm/transparent_hugepage/shmem_enabled"};
}

Finding check_steal(const MachineFacts& facts) {
  if (const auto why = unread(facts, {kCpuInfo, kStat}); !why.empty()) {
    return unknown("hypervisor", why);
  }
  const std::string& hypervisor = facts.environment.hypervisor;
  std::istringstream fields(facts.cpu_times);
  std::string cpu;
  fields >> cpu;
  // user, nice, system, idle, iowait, irq, softirq, steal
  constexpr int kSteal = 7;
  double total = 0;
  double steal = 0;
  double ticks = 0;
  for (int i = 0; i <= kSteal && fields >> ticks; ++i) {
    total += ticks;
    if (i == kSteal) steal = ticks;
  }
  const double share = total > 0 ? steal / total : 0;
  const std::string means = hypervisor.empty()
                                ? std::string("none")
                                : fmt::format("{}; {:.2f} % of the CPUs' time stolen since boot",
                                              hypervisor, 100 * share);
  if (share < kLeastSteal) return {.check = "hypervisor", .means = means};
  return {.check = "hypervisor",
          .verdict = Verdict::note,
          .means = means + ": other machines use the CPUs, and deadlines are missed",
          .fix = "give the virtual machine dedicated CPUs"};
}

}  // namespace splinecast::apps
