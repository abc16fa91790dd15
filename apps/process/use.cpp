#include "apps/process/use.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <iterator>

namespace splinecast::apps {
namespace {

/// Of `count` values, the first after the warm-up, and the first of the second half of the rest.
constexpr std::size_t warm_up(std::size_t count) { return count / 4; }
constexpr std::size_t second_half(std::size_t count) { return (warm_up(count) + count) / 2; }

}  // namespace

std::optional<ProcessUse> process_use(pid_t pid) {
  const std::string folder = fmt::format("/proc/{}", pid);
  std::ifstream statm(folder + "/statm");
  std::size_t mapped = 0;
  std::size_t resident = 0;
  std::size_t shared = 0;
  if (!(statm >> mapped >> resident >> shared)) return std::nullopt;
  std::error_code error;
  const std::filesystem::directory_iterator files(folder + "/fd", error);
  if (error) return std::nullopt;
  const auto count = std::distance(begin(files), end(files));
  const auto page = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
  return ProcessUse{.mapped_bytes = mapped * page,
                    .resident_bytes = resident * page,
                    .private_bytes = (resident - std::min(shared, resident)) * page,
                    .descriptors = static_cast<std::size_t>(count)};
}

Time cpu_time(pid_t pid) noexcept {
  clockid_t clock{};
  timespec time{};
  if (clock_getcpuclockid(pid, &clock) != 0 || clock_gettime(clock, &time) != 0) return {};
  return std::chrono::seconds(time.tv_sec) + std::chrono::nanoseconds(time.tv_nsec);
}

std::size_t Flatness::first() const noexcept {
  return most(warm_up(values_.size()), second_half(values_.size()));
}

std::size_t Flatness::second() const noexcept {
  return most(second_half(values_.size()), values_.size());
}

std::size_t Flatness::most(std::size_t begin, std::size_t end) const noexcept {
  std::size_t found = 0;
  for (std::size_t i = begin; i < end; ++i) found = std::max(found, values_[i]);
  return found;
}

}  // namespace splinecast::apps
