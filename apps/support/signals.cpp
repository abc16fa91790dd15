#include "support/signals.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <ctime>

#include "splinecast/ipc/clock.hpp"

namespace splinecast::apps {
namespace {

std::atomic<bool> stop{false};
static_assert(std::atomic<bool>::is_always_lock_free);

void request_stop(int /*signal*/) { stop.store(true, std::memory_order_relaxed); }

}  // namespace

void catch_stop_signals() {
  struct sigaction action {};
  action.sa_handler = request_stop;  // without SA_RESTART: sleeps end early
  for (const int signal : {SIGINT, SIGTERM}) sigaction(signal, &action, nullptr);
  struct sigaction hang_up {};
  sigaction(SIGHUP, nullptr, &hang_up);
  if (hang_up.sa_handler != SIG_IGN) sigaction(SIGHUP, &action, nullptr);  // nohup stays nohup
}

bool stop_requested() noexcept { return stop.load(std::memory_order_relaxed); }

bool sleep_until(core::Time instant) noexcept {
  // In slices: a signal that comes just before a sleep does not end it.
  constexpr core::Time kSlice = std::chrono::milliseconds(50);
  constexpr std::int64_t kSecond = 1'000'000'000;
  const ipc::MonotonicClock clock;
  for (;;) {
    if (stop_requested()) return false;
    const core::Time now = clock.now();
    if (now >= instant) return true;
    const std::int64_t until = std::min(instant, now + kSlice).count();
    const timespec time{.tv_sec = until / kSecond, .tv_nsec = until % kSecond};
    clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &time, nullptr);
  }
}

}  // namespace splinecast::apps
