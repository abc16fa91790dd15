#pragma once

#include <cstddef>

#include "splinecast/time.hpp"

namespace splinecast::apps {

/// When waypoints are due: an open-loop schedule, fixed before anything runs.
struct Schedule {
  Time start{};
  Time period{};
  std::size_t count = 0;

  [[nodiscard]] Time intended(std::size_t k) const noexcept {
    return start + period * static_cast<std::int64_t>(k);
  }
};

/// Carries a schedule out: for each k in turn waits until its instant and sends. However long a
/// send takes, and whatever holds the process up, no instant is moved or left out: those that have
/// passed meanwhile are served at once, and what is measured from them has the delay in it, of each
/// one. (A loop that waits a period after each send measures one late send, where its users had
/// many: coordinated omission.) `wait_until(instant)` returns false to end early.
template <typename WaitUntil, typename Send>
void run(const Schedule& schedule, WaitUntil&& wait_until, Send&& send) {
  for (std::size_t k = 0; k < schedule.count; ++k) {
    const Time intended = schedule.intended(k);
    if (!wait_until(intended)) return;
    send(k, intended);
  }
}

}  // namespace splinecast::apps
