#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <functional>
#include <utility>

#include "splinecast/ipc/clock.hpp"

namespace splinecast::testing {

/// The clock of a simulated world. Armed, it lets time pass behind one of the next readings: the
/// process that reads it is stopped there, and the world goes on without it.
class SimulatedClock final : public ipc::Clock {
 public:
  /// `now` is the world's time; `advance_to` lets the world go on until a later time, and sets it.
  SimulatedClock(const core::Time& now, std::function<void(core::Time)> advance_to)
      : now_(&now), advance_to_(std::move(advance_to)) {}

  [[nodiscard]] core::Time now() const noexcept override {
    const core::Time seen = *now_;
    if (++readings_ == 1) first_ = seen;
    if (readings_ == stop_behind_) advance_to_(seen + pause_);
    if (readings_ <= kKept) left_[readings_ - 1] = *now_;
    return seen;
  }

  /// Counts readings from 0 again and stops nobody.
  void restart() {
    readings_ = 0;
    stop_behind_ = 0;
  }

  /// Stops the process that makes the n-th reading from now on, directly after it.
  void stop_behind_reading(std::size_t n, core::Time pause) {
    restart();
    stop_behind_ = n;
    pause_ = pause;
  }

  [[nodiscard]] std::size_t readings() const noexcept { return readings_; }
  /// What the first of these readings gave.
  [[nodiscard]] core::Time first_reading() const noexcept { return first_; }
  /// The world's time when the process that made the n-th reading, n ≤ kKept, continued; of the
  /// last reading if there were fewer.
  [[nodiscard]] core::Time left_reading(std::size_t n) const noexcept {
    return left_[std::max<std::size_t>(1, std::min(n, readings_)) - 1];
  }
  static constexpr std::size_t kKept = 4;

 private:
  const core::Time* now_;
  std::function<void(core::Time)> advance_to_;
  mutable std::size_t readings_ = 0;
  mutable core::Time first_{};
  mutable std::array<core::Time, kKept> left_{};
  std::size_t stop_behind_ = 0;
  core::Time pause_{};
};

}  // namespace splinecast::testing
