#pragma once

#include <sys/types.h>

#include "splinecast/time.hpp"

namespace splinecast::apps {

/// Makes the first SIGINT, SIGTERM or SIGHUP ask the running verb to end in order. A second one
/// ends the process at once (default action). A process that is still running 5 s after the first
/// one exits with kInterrupted, whatever it is doing.
void catch_stop_signals();

/// The same in a child process, whose parent decides how long to wait for it: the 5 s only count
/// once the parent has died.
void catch_stop_signals_as_child_of(pid_t parent);

/// Whether one of them has come.
[[nodiscard]] bool stop_requested() noexcept;

/// How long ago the first one came; zero if none has.
[[nodiscard]] Time time_since_stop() noexcept;

/// Sleeps until an instant of CLOCK_MONOTONIC. Returns false at once when a stop is requested.
bool sleep_until(Time instant) noexcept;

}  // namespace splinecast::apps
