#pragma once

#include <algorithm>
#include <ctime>

#include "splinecast/core/time.hpp"

namespace splinecast::ipc {

/// Which clock a stream's times are read against.
enum class StreamClock : std::uint64_t {
  recorded = 0,   ///< the recording's own stamps, against no clock
  monotonic = 1,  ///< CLOCK_MONOTONIC of this host: a live stream
};

/// Where the time comes from. The solver takes it as an argument, so that tests drive the same
/// code with a simulated clock.
class Clock {
 public:
  Clock() = default;
  Clock(const Clock&) = delete;
  Clock& operator=(const Clock&) = delete;
  virtual ~Clock() = default;

  [[nodiscard]] virtual core::Time now() const noexcept = 0;
};

/// The instant when a timeout that begins now has passed; the end of time for very long ones.
[[nodiscard]] inline core::Time deadline(const Clock& clock, core::Time timeout) noexcept {
  const core::Time now = clock.now();
  return now + std::min(timeout, core::Time::max() - now);
}

/// CLOCK_MONOTONIC.
class MonotonicClock final : public Clock {
 public:
  [[nodiscard]] core::Time now() const noexcept override {
    timespec time{};
    clock_gettime(CLOCK_MONOTONIC, &time);
    return core::Time(std::int64_t{time.tv_sec} * 1'000'000'000 + time.tv_nsec);
  }
};

}  // namespace splinecast::ipc
