#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <string>
#include <vector>

#include "splinecast/clock.hpp"
#include "splinecast/producer.hpp"

namespace splinecast::testing {

/// A live producer that sends at 20 kHz with a lead of up to 100 ms and replaces the future at
/// every 512th waypoint. Only its constructor allocates.
class Sending {
 public:
  static constexpr Time kInterval = std::chrono::microseconds(50);

  Sending(const std::string& stream, std::size_t dimensions)
      : producer_(stream, {.dimensions = dimensions}), position_(dimensions) {
    for (Waypoint& waypoint : replacing_) waypoint.position = position_;
  }

  [[nodiscard]] Producer& producer() { return producer_; }

  /// Appends a waypoint, or replaces the future by 4. Returns false if nothing was accepted: the
  /// ring is full or the lead is reached.
  bool send() {
    const Time now = clock_.now();
    const Time earliest = std::max(producer_.earliest(), now) + kMargin;
    next_ = std::max(next_, earliest);
    if (next_ > now + kLead) return false;
    position_[0] = 1e-9 * static_cast<double>(next_.count() % 1'000'000'000);
    if (++sent_ % 512 == 0) return replace(earliest);
    const bool accepted =
        producer_.append(
            {.time = next_, .position = position_, .velocity = {}, .acceleration = {}}) ==
        AppendStatus::accepted;
    if (accepted) next_ += kInterval;
    return accepted;
  }

 private:
  static constexpr Time kLead = std::chrono::milliseconds(100);
  static constexpr Time kMargin = std::chrono::milliseconds(20);

  bool replace(Time from) {
    Time time = from + kMargin / 2;
    for (Waypoint& waypoint : replacing_) {
      waypoint.time = time;
      time += kInterval;
    }
    const bool accepted = producer_.replace_from(from, replacing_) == AppendStatus::accepted;
    if (accepted) next_ = time;
    return accepted;
  }

  Producer producer_;
  MonotonicClock clock_;
  std::vector<double> position_;
  std::array<Waypoint, 4> replacing_{};
  Time next_{};
  std::uint64_t sent_ = 0;
};

}  // namespace splinecast::testing
