#pragma once

#include "splinecast/core/time.hpp"

namespace splinecast::apps {

/// Makes SIGINT, SIGTERM and SIGHUP ask the running verb to end cleanly instead of killing it.
void catch_stop_signals();

/// Whether one of them has come.
[[nodiscard]] bool stop_requested() noexcept;

/// Sleeps until an instant of CLOCK_MONOTONIC. Returns false at once when a stop is requested.
bool sleep_until(core::Time instant) noexcept;

}  // namespace splinecast::apps
