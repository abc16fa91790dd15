#pragma once

#include <cstddef>

#include "splinecast/time.hpp"

namespace splinecast::apps {

/// The times at which waypoints are due: an open-loop schedule, fixed before the run.
struct Schedule {
  Time start{};
  Time period{};
  std::size_t count = 0;

  [[nodiscard]] Time intended(std::size_t k) const noexcept {
    return start + period * static_cast<std::int64_t>(k);
  }
};

/// Runs a schedule: for each k in order, waits until the intended instant and sends. A delay, of a
/// send or of the process, neither moves nor skips an instant: overdue ones are sent at once, and a
/// latency measured from the intended instant contains the delay. (A loop that waits one period
/// after each send measures one late send where its users saw many: coordinated omission.)
/// `wait_until(instant)` returns false to end early.
template <typename WaitUntil, typename Send>
void run(const Schedule& schedule, WaitUntil&& wait_until, Send&& send) {
  for (std::size_t k = 0; k < schedule.count; ++k) {
    const Time intended = schedule.intended(k);
    if (!wait_until(intended)) return;
    send(k, intended);
  }
}

}  // namespace splinecast::apps
