#pragma once

#include <cstddef>
#include <vector>

#include "splinecast/core/limits.hpp"
#include "splinecast/core/sliding_window.hpp"
#include "splinecast/ipc/knot_board.hpp"

namespace splinecast::ipc {

/// The limits that a motion itself shows, for entries of a stream that has been given none: per
/// dimension three times the 95 % quantile of the velocities and accelerations of its waypoints
/// over the last kSpan of motion, an acceleration at least as large as stops from that velocity
/// take. Velocities are chord slopes over at least kStep, accelerations their differences, because
/// those of neighbouring waypoints would be those of their noise.
///
/// Allocates when made only; one thread uses it.
class ShownMotion {
 public:
  static constexpr core::Time kSpan{5'000'000'000};
  static constexpr core::Time kStep{50'000'000};
  static constexpr double kFactor = 3;

  explicit ShownMotion(const KnotBoardReader& board);

  /// Takes the next waypoint, unless it follows the last one taken by less than kStep. Mostly one
  /// comparison; else O(D).
  void note(core::Time time, std::span<const double> position) noexcept {
    if (count_ == 0 || time - newest_ >= kStep) take(time, position);
  }

  /// Forgets everything, and takes the waypoints that the board holds under a head, and those of the
  /// window: O(kSpan/kStep·D).
  void restore(const core::SlidingWindow& window, const KnotBoardReader& board,
               const Head& head) noexcept;

  /// Finds the limits. `stop_time` is the length of a stop. O(kSpan/kStep·D).
  void look(core::Time stop_time) noexcept;

  /// As `look` has found them.
  [[nodiscard]] const core::MotionLimits& limits() const noexcept { return limits_; }

 private:
  static constexpr std::size_t kMost = kSpan / kStep + 1;

  void take(core::Time time, std::span<const double> position) noexcept;
  /// Where the i-th waypoint before the newest one lies.
  [[nodiscard]] std::size_t place(std::size_t i) const noexcept { return (count_ - 1 - i) % kMost; }
  [[nodiscard]] double quantile(std::size_t count) noexcept;

  std::size_t dimensions_;
  core::MotionLimits limits_;
  std::size_t count_ = 0;  ///< waypoints taken so far, of which the last kMost are kept
  core::Time newest_{};
  std::vector<core::Time> times_;
  std::vector<double> positions_;  ///< [waypoint][dimension]
  std::vector<double> values_;     ///< scratch
  std::vector<Word> numbers_;      ///< scratch
  KnotCopy knot_;                  ///< scratch
};

}  // namespace splinecast::ipc
