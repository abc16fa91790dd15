#pragma once

#include <algorithm>
#include <chrono>

#include "splinecast/time.hpp"

namespace splinecast::ipc {

/// The longest pause of a solver in the last second: the time by which a step began after it was
/// due, or from the begin of a step to its commit. An item that comes meanwhile waits for it.
class Pauses {
 public:
  /// A pause of this length ends at `now`. O(1).
  void note(Time now, Time length) noexcept {
    turn(now);
    longest_ = std::max(longest_, length);
  }

  /// The longest one of the last second, and of at most one more. O(1).
  [[nodiscard]] Time longest(Time now) noexcept {
    turn(now);
    return std::max(longest_, before_);
  }

 private:
  void turn(Time now) noexcept {
    constexpr Time kSpan = std::chrono::seconds(1);
    if (now < end_) return;
    before_ = now - end_ < kSpan ? longest_ : Time::zero();
    longest_ = {};
    end_ = now + kSpan;
  }

  Time end_{};      ///< of the second that is being measured
  Time longest_{};  ///< in it
  Time before_{};   ///< in the second before it
};

}  // namespace splinecast::ipc
