#include "apps/process/settings.hpp"

#include <fmt/format.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>

#include <cerrno>
#include <system_error>

namespace splinecast::apps {
namespace {

std::string reason() { return std::generic_category().message(errno); }

bool is_pinned_to(std::size_t cpu) {
  cpu_set_t set;
  return sched_getaffinity(0, sizeof set, &set) == 0 && CPU_COUNT(&set) == 1 &&
         CPU_ISSET(cpu, &set);
}

/// Pins this process. Returns the reason for a failure; empty on success.
std::string pin(std::size_t cpu) {
  cpu_set_t set;
  CPU_ZERO(&set);
  CPU_SET(cpu, &set);
  if (sched_setaffinity(0, sizeof set, &set) != 0) return reason();
  return is_pinned_to(cpu) ? "" : "the kernel set other CPUs";
}

std::string run_fifo(int priority) {
  sched_param wanted{};
  wanted.sched_priority = priority;
  if (sched_setscheduler(0, SCHED_FIFO, &wanted) != 0) return reason();
  sched_param found{};
  const bool took = sched_getscheduler(0) == SCHED_FIFO && sched_getparam(0, &found) == 0 &&
                    found.sched_priority == priority;
  return took ? "" : "the kernel set another policy";
}

std::string lock_memory() {
  return mlockall(MCL_CURRENT | MCL_FUTURE) == 0 ? "" : reason();  // NOLINT(hicpp-signed-bitwise)
}

}  // namespace

std::vector<std::string> adopt(const ProcessSettings& settings, const std::string& role) {
  std::vector<std::string> failed;
  const auto note = [&](const std::string& what, const std::string& why) {
    if (!why.empty()) failed.push_back(fmt::format("{} {}: {}", role, what, why));
  };
  prctl(PR_SET_TIMERSLACK, 1);
  if (settings.cpu)
    note(fmt::format("is not pinned to CPU {}", *settings.cpu),
         pin(static_cast<std::size_t>(*settings.cpu)));
  if (settings.lock_memory) note("has not locked its memory (mlockall)", lock_memory());
  if (settings.fifo) {
    note(fmt::format("does not run under SCHED_FIFO at priority {}", settings.priority),
         run_fifo(settings.priority));
  }
  return failed;
}

std::size_t usable_cpus() {
  cpu_set_t set;
  if (sched_getaffinity(0, sizeof set, &set) != 0) return 1;
  return static_cast<std::size_t>(CPU_COUNT(&set));
}

Usage usage_now() noexcept {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  // The C library declares these as members of unions.  NOLINTBEGIN(*-union-access)
  return {.minor_faults = usage.ru_minflt,
          .major_faults = usage.ru_majflt,
          .voluntary_switches = usage.ru_nvcsw,
          .involuntary_switches = usage.ru_nivcsw};
  // NOLINTEND(*-union-access)
}

nlohmann::ordered_json to_json(const Usage& before, const Usage& after) {
  return {{"minor_faults", after.minor_faults - before.minor_faults},
          {"major_faults", after.major_faults - before.major_faults},
          {"voluntary_switches", after.voluntary_switches - before.voluntary_switches},
          {"involuntary_switches", after.involuntary_switches - before.involuntary_switches}};
}

}  // namespace splinecast::apps
