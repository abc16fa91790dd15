#pragma once

#include <cstddef>
#include <vector>

#include "core/online/sliding_window.hpp"
#include "ipc/board/knot.hpp"
#include "ipc/board/reader.hpp"
#include "ipc/layout/summary.hpp"
#include "splinecast/limits.hpp"

namespace splinecast::ipc {

/// The limits that a motion itself shows, for entries of a stream without given limits: per
/// dimension three times the 95 % quantile of the velocities and accelerations of its waypoints
/// over the last kSpan of motion. The acceleration is at least the one that a stop from that
/// velocity needs. Velocities are chord slopes over about kStep and accelerations are their
/// differences, because the differences of neighbouring waypoints would be mostly noise. A solver
/// that takes over knows earlier runs only from the board, so it may find other limits.
///
/// Allocates only when constructed; one thread uses it.
class ShownMotion {
 public:
  static constexpr Time kSpan{5'000'000'000};
  static constexpr Time kStep{100'000'000};
  static constexpr double kFactor = 3;

  explicit ShownMotion(const KnotBoardReader& board);

  /// Takes a waypoint if it is the first one at or after a multiple of kStep, so the choice does
  /// not depend on the first call. Usually one comparison, else O(D).
  void note(Time time, std::span<const double> position) noexcept {
    if (time >= next_) take(time, position);
  }

  /// Drops the waypoints after a time.
  void forget_after(Time t) noexcept;

  /// Drops everything, and takes the waypoints that the curve of a summary meets before `end`, as
  /// far as the board holds them. Any process may call it: it skips knots that a writer changes at
  /// the same time. O(kSpan/kStep·(log n + D)).
  void restore(const KnotBoardReader& board, const Summary& summary, Time end) noexcept;

  /// The same for the writer; then also takes the waypoints of the run from number `first` on, from
  /// the passed slots and from the window. O((kSpan/kStep + kPassedSlots)·D).
  void restore(const core::SlidingWindow& window, const KnotBoardReader& board,
               const Summary& summary, Time end, std::size_t first) noexcept;

  /// Finds the limits, if a waypoint has been taken since the last call. `stop_time` is the length
  /// of a stop, the same in all calls. O(kSpan/kStep·D).
  void look(Time stop_time) noexcept;

  /// The limits that the last `look` found.
  [[nodiscard]] const MotionLimits& limits() const noexcept { return limits_; }

 private:
  static constexpr std::size_t kMost = kSpan / kStep + 1;

  void take_met(const KnotBoardReader& board, const Summary& summary, Time end) noexcept;
  void take_passed(const KnotBoardReader& board, const Summary& summary, std::size_t first,
                   std::size_t end) noexcept;
  void take(Time time, std::span<const double> position) noexcept;
  void forget_all() noexcept;
  /// The index of the i-th waypoint before the newest one.
  [[nodiscard]] std::size_t place(std::size_t i) const noexcept { return (count_ - 1 - i) % kMost; }
  [[nodiscard]] double quantile(std::size_t count) noexcept;

  std::size_t dimensions_;
  MotionLimits limits_;
  std::size_t count_ = 0;    ///< waypoints taken so far
  std::size_t first_ = 0;    ///< number of the oldest waypoint that is kept: at most kMost are kept
  bool has_looked_ = false;  ///< the limits are up to date
  Time next_ = Time::min();  ///< the next waypoint is taken from this time on
  std::vector<Time> times_;
  std::vector<double> positions_;  ///< [waypoint][dimension]
  std::vector<double> values_;     ///< scratch
  std::vector<Word> numbers_;      ///< scratch
  KnotCopy knot_;                  ///< scratch
};

}  // namespace splinecast::ipc
