#include "apps/machine/environment.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <set>
#include <string_view>
#include <system_error>

#include "apps/cli/version.hpp"
#include "apps/files/numbers.hpp"

namespace splinecast::apps {
namespace {

namespace fs = std::filesystem;

/// The first line of a file; empty if it cannot be read.
std::string first_line(const fs::path& file) {
  std::ifstream in(file);
  std::string line;
  std::getline(in, line);
  return std::string(without_blanks(line));
}

/// The value of the first line of /proc/cpuinfo that has one of these names.
std::string cpu_fact(const fs::path& root, std::initializer_list<std::string_view> names) {
  std::ifstream in(root / "proc/cpuinfo");
  for (std::string line; std::getline(in, line);) {
    const std::size_t colon = line.find(':');
    if (colon == std::string::npos) continue;
    const std::string_view name = without_blanks(std::string_view(line).substr(0, colon));
    if (std::ranges::find(names, name) == names.end()) continue;
    return std::string(without_blanks(std::string_view(line).substr(colon + 1)));
  }
  return {};
}

std::string governors(const fs::path& root) {
  std::set<std::string> distinct;
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(root / "sys/devices/system/cpu", none)) {
    const std::string governor = first_line(entry.path() / "cpufreq/scaling_governor");
    if (!governor.empty()) distinct.insert(governor);
  }
  return fmt::format("{}", fmt::join(distinct, ","));
}

/// Whether a text contains a word between blanks.
bool has_word(const std::string& text, std::string_view word) {
  return fmt::format(" {} ", text).find(fmt::format(" {} ", word)) != std::string::npos;
}

std::string preemption(const fs::path& root) {
  if (first_line(root / "sys/kernel/realtime") == "1") return "PREEMPT_RT";
  const std::string build = first_line(root / "proc/sys/kernel/version");
  for (const char* const kind : {"PREEMPT_RT", "PREEMPT_DYNAMIC", "PREEMPT"}) {
    if (has_word(build, kind)) return kind;
  }
  return build.empty() ? "" : "none";
}

std::string hypervisor(const fs::path& root) {
  std::string type = first_line(root / "sys/hypervisor/type");
  if (!type.empty()) return type;
  type = first_line(root / "proc/device-tree/hypervisor/compatible");
  if (!type.empty()) return type;
  if (!has_word(cpu_fact(root, {"flags"}), "hypervisor")) return {};
  const std::string maker = first_line(root / "sys/class/dmi/id/sys_vendor");
  const std::string product = first_line(root / "sys/class/dmi/id/product_name");
  if (maker.empty() && product.empty()) return "unknown";
  return std::string(without_blanks(fmt::format("{} {}", maker, product)));
}

}  // namespace

Environment read_environment(const fs::path& root) {
  const fs::path cpus = root / "sys/devices/system/cpu";
  const fs::path clock = root / "sys/devices/system/clocksource/clocksource0/current_clocksource";
  return {.version = kVersion,
          .cpu = cpu_fact(root, {"model name", "Model", "cpu model"}),
          .online = first_line(cpus / "online"),
          .isolated = first_line(cpus / "isolated"),
          .governor = governors(root),
          .kernel = first_line(root / "proc/sys/kernel/osrelease"),
          .preemption = preemption(root),
          .hypervisor = hypervisor(root),
          .clock = first_line(clock),
          .rt_runtime = first_line(root / "proc/sys/kernel/sched_rt_runtime_us"),
          .rt_period = first_line(root / "proc/sys/kernel/sched_rt_period_us")};
}

std::optional<Time> throttled_time(const Environment& environment) {
  if (environment.rt_runtime == "-1") return Time::zero();
  const auto runtime = parse_time(environment.rt_runtime, TimeUnit::microseconds);
  const auto period = parse_time(environment.rt_period, TimeUnit::microseconds);
  if (!runtime || !period) return std::nullopt;
  return std::max(*period - *runtime, Time::zero());
}

nlohmann::ordered_json to_json(const Environment& environment) {
  return {{"version", environment.version},       {"cpu", environment.cpu},
          {"online", environment.online},         {"isolated", environment.isolated},
          {"governor", environment.governor},     {"kernel", environment.kernel},
          {"preemption", environment.preemption}, {"hypervisor", environment.hypervisor},
          {"clock", environment.clock},           {"rt_runtime_us", environment.rt_runtime},
          {"rt_period_us", environment.rt_period}};
}

}  // namespace splinecast::apps
