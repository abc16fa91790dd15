#pragma once

#include <algorithm>
#include <chrono>
#include <optional>

#include "ipc/python/held.hpp"
#include "splinecast/clock.hpp"

/// Waits without the GIL, which a signal to the main thread ends.
namespace splinecast::python {

/// How often a wait lets Python handle signals.
inline constexpr Time kSignalSlice = std::chrono::milliseconds(50);
/// How often a wait lets other threads use the object.
inline constexpr Time kTurnSlice = std::chrono::milliseconds(5);

/// The end of a timeout; Time::max() without one.
[[nodiscard]] inline Time end_of(const std::optional<Time>& timeout) {
  return timeout ? deadline(MonotonicClock(), *timeout) : Time::max();
}

/// Runs the signal handlers of Python. Throws what they raise, such as KeyboardInterrupt.
inline void check_signals() {
  if (PyErr_CheckSignals() != 0) throw py::error_already_set();
}

/// Calls `wait(role, timeout)`, which must not run Python code, until it returns true, or until
/// `end`. Returns whether it did. Requires the GIL; releases it in between.
template <typename Role, typename Wait>
bool wait_until(const Held<Role>& held, Time end, const Wait& wait) {
  const MonotonicClock clock;
  held.require_own_process();
  for (;;) {
    bool is_done = false;
    without_gil([&] {
      const Time slice_end = std::min(end, clock.now() + kSignalSlice);
      for (Time left = slice_end - clock.now();; left = slice_end - clock.now()) {
        const Time turn = std::clamp(left, Time::zero(), kTurnSlice);
        is_done = held.use_without_gil([&](Role& role) { return wait(role, turn); });
        if (is_done || left <= kTurnSlice) return;
      }
    });
    if (is_done) return true;
    check_signals();
    if (clock.now() >= end) return false;
  }
}

}  // namespace splinecast::python
