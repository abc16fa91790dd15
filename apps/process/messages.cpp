#include "apps/process/messages.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <string>

#include "ipc/memory/names.hpp"
#include "splinecast/clock.hpp"

namespace splinecast::apps {

Progress::Progress() : terminal_(isatty(STDERR_FILENO) == 1) {}

Progress::~Progress() {
  if (shown_) std::fputs("\r\033[K", stderr);
}

void Progress::show(std::string_view text) {
  if (!terminal_) return;
  const Time now = MonotonicClock().now();
  if (now < next_) return;
  constexpr Time kPeriod = std::chrono::milliseconds(100);
  next_ = now + kPeriod;
  shown_ = true;
  fmt::print(stderr, "\r\033[K{}", text);
  std::fflush(stderr);
}

std::string shown(std::string_view text) {
  constexpr std::size_t kMost = 60;
  if (text.size() <= kMost) return ipc::printable(text);
  std::size_t end = kMost;
  const auto continues = [&](std::size_t i) {
    return (static_cast<unsigned char>(text[i]) & 0xc0U) == 0x80U;
  };
  while (end > kMost - 4 && continues(end)) --end;  // keeps characters of UTF-8 whole
  return ipc::printable(text.substr(0, end)) + "…";
}

void say(std::string_view text) {
  std::string lines = "splinecast: ";
  for (std::size_t end = text.find('\n'); end != std::string_view::npos; end = text.find('\n')) {
    lines += ipc::printable(text.substr(0, end)) + '\n';
    text.remove_prefix(end + 1);
  }
  lines += ipc::printable(text) + '\n';
  std::fputs(lines.c_str(), stderr);  // write errors are ignored
}

}  // namespace splinecast::apps
