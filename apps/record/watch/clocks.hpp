#pragma once

#include "splinecast/clock.hpp"
#include "splinecast/time.hpp"

namespace splinecast::apps::record {

/// The wall clock, read by CLOCK_MONOTONIC: their distance is measured once, so that the times of a
/// recording are not moved when the wall clock is set.
class WallClock {
 public:
  WallClock() noexcept : offset_(measured()) {}

  [[nodiscard]] Time now() const noexcept { return monotonic_.now() + offset_; }
  /// The wall clock minus CLOCK_MONOTONIC.
  [[nodiscard]] Time offset() const noexcept { return offset_; }

 private:
  [[nodiscard]] static Time measured() noexcept {
    timespec time{};
    clock_gettime(CLOCK_REALTIME, &time);
    return Time(std::int64_t{time.tv_sec} * 1'000'000'000 + time.tv_nsec) - MonotonicClock().now();
  }
  MonotonicClock monotonic_;
  Time offset_;
};

}  // namespace splinecast::apps::record
