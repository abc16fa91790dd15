#pragma once

#include <algorithm>
#include <cstdint>
#include <ctime>

#include "splinecast/time.hpp"

namespace [[gnu::visibility("default")]] splinecast {

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

  /// The time now, in nanoseconds from the clock's origin; must never go back. Every step of a live
  /// stream reads it a few times: it should be cheap, and must not block.
  [[nodiscard]] virtual Time now() const noexcept = 0;

  /// The same to within some milliseconds, never later: cheaper where that is enough.
  [[nodiscard]] virtual Time about_now() const noexcept { return now(); }
};

/// The instant when a timeout that begins now has passed; the end of time for very long ones.
[[nodiscard]] inline Time deadline(const Clock& clock, Time timeout) noexcept {
  const Time now = clock.now();
  return now + std::min(timeout, Time::max() - now);
}

/// CLOCK_MONOTONIC. now() takes tens of nanoseconds, and no system call where the kernel's clock
/// source allows that (tsc, arch_sys_counter).
class MonotonicClock final : public Clock {
 public:
  [[nodiscard]] Time now() const noexcept override { return read(CLOCK_MONOTONIC); }
  [[nodiscard]] Time about_now() const noexcept override { return read(CLOCK_MONOTONIC_COARSE); }

 private:
  [[nodiscard]] static Time read(clockid_t clock) noexcept {
    timespec time{};
    clock_gettime(clock, &time);
    return Time(std::int64_t{time.tv_sec} * 1'000'000'000 + time.tv_nsec);
  }
};

}  // namespace splinecast
