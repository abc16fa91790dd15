#pragma once

#include <algorithm>
#include <cstdint>
#include <ctime>
#include <optional>
#include <string>

#include "splinecast/time.hpp"

namespace [[gnu::visibility("default")]] splinecast {

/// The clock of a stream's times.
enum class StreamClock : std::uint64_t {
  recorded = 0,   ///< a recorded stream: times are time stamps of a recording
  monotonic = 1,  ///< a live stream: times are those of this host's CLOCK_MONOTONIC
  law = 2,        ///< a live stream that follows a time law: its times are the law's stream time,
                  ///< readers give host time
};

/// Whether a stream of this clock moves with the host's time.
[[nodiscard]] constexpr bool is_live(StreamClock clock) noexcept {
  return clock != StreamClock::recorded;
}

/// The source of the time. The solver takes it as an argument, so that tests can simulate a clock.
class Clock {
 public:
  Clock() = default;
  Clock(const Clock&) = delete;
  Clock& operator=(const Clock&) = delete;
  virtual ~Clock() = default;

  /// The current time, in nanoseconds since the clock's origin. Must never decrease and must not
  /// block. Should be cheap: each step of a live stream calls it a few times.
  [[nodiscard]] virtual Time now() const noexcept = 0;

  /// The current time, or up to some milliseconds earlier; never later than now(). Cheaper.
  [[nodiscard]] virtual Time about_now() const noexcept { return now(); }

  /// The time of the host's clock at which the last now() returned `now`.
  [[nodiscard]] virtual Time host_time(Time now) const noexcept { return now; }

  /// The latest time that this clock can show when the host's clock has advanced by `ahead` since
  /// `now`, the result of the last now().
  [[nodiscard]] virtual Time latest(Time now, Time ahead) const noexcept { return now + ahead; }

  /// The time that this clock shows if it is certain, as of the last now(), that it does not
  /// advance as far as it is known ahead: of a stream whose time law is held.
  [[nodiscard]] virtual std::optional<Time> held() const noexcept { return std::nullopt; }
};

/// The end of a timeout that begins now, at most Time::max(); a negative timeout counts as 0.
[[nodiscard]] inline Time deadline(const Clock& clock, Time timeout) noexcept {
  const Time now = clock.now();
  return now + std::clamp(timeout, Time::zero(), Time::max() - now);
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

/// Compares a time that a live stream refuses with now on CLOCK_MONOTONIC, and names the clock that
/// the time looks like, if it is within a day of that clock or counts from 0:
/// `1764300000 s is 1764299087 s after now, 912.4 s on CLOCK_MONOTONIC; it looks like
/// CLOCK_REALTIME`. Two system calls at most.
[[nodiscard]] std::string compared_with_now(Time time);

}  // namespace splinecast
