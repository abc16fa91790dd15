#include "ipc/memory/process_life.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <ctime>
#include <limits>
#include <optional>
#include <string_view>

namespace splinecast::ipc {
namespace {

Time now_by(clockid_t clock) noexcept {
  timespec now{};
  clock_gettime(clock, &now);
  return std::chrono::seconds(now.tv_sec) + std::chrono::nanoseconds(now.tv_nsec);
}

struct ProcessStat {
  char state = '?';
  Time started{};  ///< by CLOCK_BOOTTIME
};

/// Parses the text of /proc/PID/stat, see proc(5): the state follows the name in brackets, and the
/// start time, in ticks, is the 19th field after that.
std::optional<ProcessStat> parse_stat(std::string_view text) noexcept {
  constexpr int kFieldsBetween = 19;
  const std::size_t name_end = text.rfind(") ");
  if (name_end == std::string_view::npos || name_end + 2 >= text.size()) return std::nullopt;
  text.remove_prefix(name_end + 2);
  ProcessStat stat{.state = text.front()};
  for (int i = 0; i < kFieldsBetween; ++i) {
    const std::size_t space = text.find(' ');
    if (space == std::string_view::npos) return std::nullopt;
    text.remove_prefix(space + 1);
  }
  std::int64_t ticks = 0;
  if (std::from_chars(text.data(), text.data() + text.size(), ticks).ec != std::errc()) {
    return std::nullopt;
  }
  const std::int64_t rate = sysconf(_SC_CLK_TCK);
  stat.started = std::chrono::seconds(ticks / rate) +
                 std::chrono::nanoseconds(ticks % rate * 1'000'000'000 / rate);
  return stat;
}

std::optional<ProcessStat> read_stat(std::uint64_t pid) noexcept {
  std::array<char, 64> path{};
  std::snprintf(path.data(), path.size(), "/proc/%llu/stat", static_cast<unsigned long long>(pid));
  const int file = open(path.data(), O_RDONLY | O_CLOEXEC);
  if (file < 0) return std::nullopt;
  std::array<char, 1024> text{};
  const ssize_t size = read(file, text.data(), text.size());
  close(file);
  if (size <= 0) return std::nullopt;
  return parse_stat({text.data(), static_cast<std::size_t>(size)});
}

}  // namespace

bool process_lives(std::uint64_t pid, Time since) noexcept {
  if (pid == 0 || pid > std::numeric_limits<pid_t>::max()) return false;
  if (kill(static_cast<pid_t>(pid), 0) != 0 && errno == ESRCH) return false;
  const auto stat = read_stat(pid);
  if (!stat) return true;
  if (stat->state == 'Z' || stat->state == 'X') return false;
  // Compares ages, not times: the start time is by CLOCK_BOOTTIME, which also advances while the
  // machine is suspended; CLOCK_MONOTONIC does not.
  const Time now = now_by(CLOCK_MONOTONIC);
  const Time owned = now - std::clamp(since, Time::zero(), now);
  return now_by(CLOCK_BOOTTIME) - stat->started >= owned;
}

}  // namespace splinecast::ipc
