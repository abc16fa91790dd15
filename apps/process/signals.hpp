#pragma once

#include <sys/types.h>

#include "splinecast/time.hpp"

namespace splinecast::apps {

/// Installs handlers: the first SIGINT, SIGTERM or SIGHUP requests a stop of the running verb. A
/// second one ends the process at once (default action). A process that still runs 5 s after the
/// first one, or after its last extend_shutdown(), exits with kInterrupted.
void catch_stop_signals();

/// The same for a child process. Its parent decides how long to wait for it: the limit of 5 s
/// applies only if the parent has died.
void catch_stop_signals_as_child_of(pid_t parent);

/// Restarts the 5 s, if a signal has arrived: for steps of a clean shutdown whose number has a
/// bound, each of which can take long on a busy machine.
void extend_shutdown() noexcept;

/// Whether one of these signals has arrived.
[[nodiscard]] bool stop_requested() noexcept;

/// Time since the first of these signals; zero if there was none.
[[nodiscard]] Time time_since_stop() noexcept;

/// Sleeps until an instant of CLOCK_MONOTONIC. Returns false at most 50 ms after a stop request.
bool sleep_until(Time instant) noexcept;

}  // namespace splinecast::apps
