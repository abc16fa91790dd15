#pragma once

#include "splinecast/clock.hpp"

namespace splinecast::ipc {

/// A clock that advances by `step` after every reading.
class RunningClock final : public Clock {
 public:
  RunningClock(Time now, Time step) : now_(now), step_(step) {}
  [[nodiscard]] Time now() const noexcept override {
    now_ += step_;
    return now_ - step_;
  }

 private:
  mutable Time now_;
  Time step_;
};

}  // namespace splinecast::ipc
