#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "splinecast/limits.hpp"
#include "splinecast/time.hpp"

namespace splinecast::core {

/// The limits that a motion itself shows, where none are given: per dimension three times the 95 %
/// quantile of the velocities and accelerations of its waypoints over the last kSpan of motion. The
/// acceleration is at least the mean one of a stop from that velocity. Velocities are chord
/// slopes over about kStep and accelerations are their differences, because the differences of
/// neighbouring waypoints would be mostly noise.
///
/// Allocates only when constructed; one thread uses it.
class ShownLimits {
 public:
  static constexpr Time kSpan{5'000'000'000};
  static constexpr Time kStep{100'000'000};
  static constexpr double kFactor = 3;

  explicit ShownLimits(std::size_t dimensions);

  /// Takes a waypoint if it is the first one at or after a multiple of kStep, so the choice does
  /// not depend on the first call. Usually one comparison, else O(D).
  void note(Time time, std::span<const double> position) noexcept {
    if (is_replaced_) forget_from(time);
    if (time >= next_) take(time, position);
  }

  /// Drops the waypoints after a time.
  void forget_after(Time t) noexcept;

  /// The next waypoint replaces those at its time and later. Those before it stay although the
  /// motion may not meet them: plans of one waypoint, of which each replaces the one before, show
  /// the motion as the waypoints of one plan do.
  void replace_from_next() noexcept { is_replaced_ = true; }

  /// Drops everything.
  void forget_all() noexcept;

  /// Finds the limits, if a waypoint has been taken since the last call. `stop_length` is the
  /// length of a stop, the same in all calls. O(kSpan/kStep·D).
  void look(Time stop_length) noexcept;

  /// The limits that the last `look` found.
  [[nodiscard]] const MotionLimits& limits() const noexcept { return limits_; }

 protected:
  static constexpr std::size_t kMost = kSpan / kStep + 1;

 private:
  void forget_from(Time time) noexcept;
  void take(Time time, std::span<const double> position) noexcept;
  /// The index of the i-th waypoint before the newest one.
  [[nodiscard]] std::size_t place(std::size_t i) const noexcept { return (count_ - 1 - i) % kMost; }
  [[nodiscard]] double quantile(std::size_t count) noexcept;

  std::size_t dimensions_;
  MotionLimits limits_;
  std::size_t count_ = 0;    ///< waypoints taken so far
  std::size_t first_ = 0;    ///< number of the oldest waypoint that is kept: at most kMost are kept
  bool has_looked_ = false;  ///< the limits are up to date
  bool is_replaced_ = false;  ///< see replace_from_next()
  Time next_ = Time::min();   ///< the next waypoint is taken from this time on
  std::vector<Time> times_;
  std::vector<double> positions_;  ///< [waypoint][dimension]
  std::vector<double> values_;     ///< scratch
};

}  // namespace splinecast::core
