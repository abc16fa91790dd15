#include "apps/process/signals.hpp"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <ctime>
#include <string_view>

#include "apps/process/exit_codes.hpp"
#include "splinecast/clock.hpp"

namespace splinecast::apps {
namespace {

constexpr std::array kStopSignals{SIGINT, SIGTERM, SIGHUP};
constexpr unsigned kGraceSeconds = 5;

// The state of the signal handlers. A forked child has its own copy.
std::atomic<bool> stop{false};
std::atomic<std::int64_t> stopped_at{0};  ///< CLOCK_MONOTONIC, ns
std::atomic<pid_t> waiting_parent{0};     ///< parent that waits for this child; else 0
static_assert(std::atomic<bool>::is_always_lock_free);
static_assert(std::atomic<std::int64_t>::is_always_lock_free);
static_assert(std::atomic<pid_t>::is_always_lock_free);

void set_handler(int signal, void (*handler)(int)) {
  struct sigaction action {};
  action.sa_handler = handler;  // no SA_RESTART: a signal interrupts sleeps and writes
  sigaction(signal, &action, nullptr);
}

void (*handler_of(int signal))(int) {
  struct sigaction action {};
  sigaction(signal, nullptr, &action);
  return action.sa_handler;
}

/// Handler of SIGALRM: the process did not end in time. Calls only async-signal-safe functions.
void end_at_once(int /*signal*/) {
  constexpr std::string_view kMessage = "splinecast: did not end within 5 s of a signal: aborted\n";
  [[maybe_unused]] const ssize_t written = write(STDERR_FILENO, kMessage.data(), kMessage.size());
  _exit(kInterrupted);
}

/// Whether no living parent waits for this process, so that it limits its own shutdown.
bool is_on_its_own() {
  const pid_t waiting = waiting_parent.load(std::memory_order_relaxed);
  return waiting == 0 || getppid() != waiting;
}

/// Handler of the stop signals. Calls only async-signal-safe functions.
void request_stop(int /*signal*/) {
  const int error = errno;
  stopped_at.store(MonotonicClock().now().count(), std::memory_order_relaxed);
  stop.store(true, std::memory_order_relaxed);
  for (const int signal : kStopSignals) {
    if (handler_of(signal) == request_stop) set_handler(signal, SIG_DFL);
  }
  if (is_on_its_own()) alarm(kGraceSeconds);
  errno = error;
}

void catch_signals() {
  set_handler(SIGALRM, end_at_once);
  sigset_t alarm_signal;
  sigemptyset(&alarm_signal);
  sigaddset(&alarm_signal, SIGALRM);
  sigprocmask(SIG_UNBLOCK, &alarm_signal, nullptr);  // the signal mask is inherited
  for (const int signal : kStopSignals) {
    if (signal == SIGHUP && handler_of(signal) == SIG_IGN) continue;  // keep the setting of nohup
    set_handler(signal, request_stop);
  }
}

}  // namespace

void catch_stop_signals() {
  waiting_parent.store(0, std::memory_order_relaxed);
  catch_signals();
}

void catch_stop_signals_as_child_of(pid_t parent) {
  waiting_parent.store(parent, std::memory_order_relaxed);
  alarm(0);  // the handler inherited from the parent may have set it
  catch_signals();
}

void extend_shutdown() noexcept {
  if (stop_requested() && is_on_its_own()) alarm(kGraceSeconds);
}

bool stop_requested() noexcept { return stop.load(std::memory_order_relaxed); }

Time time_since_stop() noexcept {
  if (!stop_requested()) return Time::zero();
  return MonotonicClock().now() - Time(stopped_at.load(std::memory_order_relaxed));
}

bool sleep_until(Time instant) noexcept {
  // Sleep in slices: a signal that arrives just before a sleep does not interrupt it.
  constexpr Time kSlice = std::chrono::milliseconds(50);
  constexpr std::int64_t kSecond = 1'000'000'000;
  const MonotonicClock clock;
  for (;;) {
    if (stop_requested()) return false;
    const Time now = clock.now();
    if (now >= instant) return true;
    const std::int64_t until = std::min(instant, now + kSlice).count();
    const timespec time{.tv_sec = until / kSecond, .tv_nsec = until % kSecond};
    clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &time, nullptr);
  }
}

}  // namespace splinecast::apps
