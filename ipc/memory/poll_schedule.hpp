#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>

#include "splinecast/time.hpp"

namespace splinecast::ipc {

/// Which of many streams a sweep reads: all that are active, and one that has been idle for
/// kIdleAfter once per kIdlePause, a different part of these at each sweep. If every stream is
/// idle, the sweeps themselves are kIdlePause apart. One thread uses it.
class PollSchedule {
 public:
  static constexpr Time kIdleAfter = std::chrono::seconds(1);
  static constexpr Time kIdlePause = std::chrono::milliseconds(20);

  /// `pause`, above 0: the time between two sweeps while a stream is active.
  explicit PollSchedule(Time pause = std::chrono::milliseconds(1))
      : pause_(pause),
        idle_sweeps_(static_cast<std::size_t>(std::max<Time::rep>(kIdlePause / pause, 1))) {}

  /// Begins a sweep at `now`, which reads all streams if `reads_all` or if all were idle.
  void begin(Time now, bool reads_all = false) noexcept {
    ++sweeps_;
    idle_since_ = now - kIdleAfter;
    reads_all_ = reads_all || all_idle_;
    all_idle_ = true;
  }

  /// Whether this sweep reads stream number `index`, which had work last at `active`. `may_idle`:
  /// nothing is due on it.
  [[nodiscard]] bool reads(std::size_t index, Time active, bool may_idle = true) noexcept {
    const bool is_idle = may_idle && active <= idle_since_;
    all_idle_ = all_idle_ && is_idle;
    return !is_idle || reads_all_ || (sweeps_ + index) % idle_sweeps_ == 0;
  }

  /// Records that this sweep has found work: the next one comes after `pause`.
  void note_work() noexcept { all_idle_ = false; }

  /// The time from this sweep to the next one.
  [[nodiscard]] Time next_pause() const noexcept {
    return all_idle_ ? std::max(pause_, kIdlePause) : pause_;
  }

 private:
  Time pause_;
  std::size_t idle_sweeps_;  ///< one sweep out of this many reads an idle stream
  std::size_t sweeps_ = 0;
  Time idle_since_{};
  bool reads_all_ = false;
  bool all_idle_ = false;
};

}  // namespace splinecast::ipc
