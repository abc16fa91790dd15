#pragma once

#include <cstddef>
#include <vector>

#include "core/online/sliding_window.hpp"
#include "ipc/board/knot.hpp"
#include "ipc/board/reader.hpp"
#include "ipc/layout/summary.hpp"
#include "splinecast/limits.hpp"

namespace splinecast::ipc {

/// The limits that a motion itself shows, for entries of a stream that has been given none: per
/// dimension three times the 95 % quantile of the velocities and accelerations of its waypoints
/// over the last kSpan of motion, an acceleration at least as large as stops from that velocity
/// take. Velocities are chord slopes over about kStep, accelerations their differences, because
/// those of neighbouring waypoints would be those of their noise. A solver that takes over knows of
/// former runs only what the board holds: it may find other limits.
///
/// Allocates when made only; one thread uses it.
class ShownMotion {
 public:
  static constexpr Time kSpan{5'000'000'000};
  static constexpr Time kStep{100'000'000};
  static constexpr double kFactor = 3;

  explicit ShownMotion(const KnotBoardReader& board);

  /// Takes a waypoint if it is the first one at or after a multiple of kStep: which ones are taken
  /// does not depend on where that began. Mostly one comparison; else O(D).
  void note(Time time, std::span<const double> position) noexcept {
    if (time >= next_) take(time, position);
  }

  /// Forgets the waypoints behind a time.
  void forget_after(Time t) noexcept;

  /// Forgets everything, and takes the waypoints that the curve meets before `end`, by what the
  /// board holds under a head. Anybody may look: what a writer changes meanwhile is left out.
  /// O(kSpan/kStep·(log n + D)).
  void restore(const KnotBoardReader& board, const Head& head, Time end) noexcept;

  /// The same for the writer, and then those of the run from number `first` on: from the slots of
  /// those that are passed over, and from the window. O((kSpan/kStep + kPassedSlots)·D).
  void restore(const core::SlidingWindow& window, const KnotBoardReader& board, const Head& head,
               Time end, std::size_t first) noexcept;

  /// Finds the limits, if a waypoint has been taken since they were found. `stop_time` is the
  /// length of a stop, always the same. O(kSpan/kStep·D).
  void look(Time stop_time) noexcept;

  /// As `look` has found them.
  [[nodiscard]] const MotionLimits& limits() const noexcept { return limits_; }

 private:
  static constexpr std::size_t kMost = kSpan / kStep + 1;

  void take_met(const KnotBoardReader& board, const Head& head, Time end) noexcept;
  void take_passed(const KnotBoardReader& board, const Head& head, std::size_t first,
                   std::size_t end) noexcept;
  void take(Time time, std::span<const double> position) noexcept;
  void forget_all() noexcept;
  /// Where the i-th waypoint before the newest one lies.
  [[nodiscard]] std::size_t place(std::size_t i) const noexcept { return (count_ - 1 - i) % kMost; }
  [[nodiscard]] double quantile(std::size_t count) noexcept;

  std::size_t dimensions_;
  MotionLimits limits_;
  std::size_t count_ = 0;  ///< waypoints taken so far
  std::size_t first_ = 0;  ///< the oldest one of them that is kept, at most kMost before the newest
  bool has_looked_ = false;  ///< the limits are those of what has been taken
  Time next_ = Time::min();  ///< from when on the next one is taken
  std::vector<Time> times_;
  std::vector<double> positions_;  ///< [waypoint][dimension]
  std::vector<double> values_;     ///< scratch
  std::vector<Word> numbers_;      ///< scratch
  KnotCopy knot_;                  ///< scratch
};

}  // namespace splinecast::ipc
