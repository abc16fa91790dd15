#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

#include "ipc/python/held.hpp"
#include "ipc/python/values/times.hpp"
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

/// Makes a request of a commander or a stopper; with `wait`, returns when it is in force, or raises
/// TimeoutError. Returns the number of the request.
template <typename Role, typename Make>
std::uint64_t in_force(Held<Role>& held, py::handle wait, const std::string& name,
                       const Make& make) {
  const auto timeout = optional_duration(wait, "wait");
  const std::uint64_t number = held.use(make);
  if (!timeout) return number;
  const bool is_in_force = wait_until(held, end_of(timeout), [number](Role& own, Time time) {
    return own.wait_in_force(number, time);
  });
  if (is_in_force) return number;
  const std::string text = "request " + std::to_string(number) + " of '" + name + "' to '" +
                           held.stream() + "' is not in force after " +
                           std::to_string(to_seconds(*timeout)) + " s; it remains";
  PyErr_SetString(PyExc_TimeoutError, text.c_str());
  throw py::error_already_set();
}

}  // namespace splinecast::python
