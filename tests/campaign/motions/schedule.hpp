#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "tests/campaign/motions/sines.hpp"

namespace splinecast::campaign {

/// A call of a producer: waypoints appended, or in place of all behind `replaces_from`. Times in s.
struct Call {
  double at = 0;
  std::vector<double> times;
  std::vector<std::vector<double>> positions;  ///< [waypoint][joint]
  std::optional<double> replaces_from{};
};

/// What a producer does while the motion goes on, and what happens to it and to the solver.
struct Schedule {
  std::vector<Call> calls;                          ///< by `at`
  std::vector<std::pair<double, double>> pauses{};  ///< of the producer: from, until
  std::vector<std::pair<double, double>>
      deaths{};  ///< of the solver: from, until another one comes
  /// What plans add to the motion, in rad: from when on, how much. None: they follow it.
  std::vector<std::pair<double, double>> offsets{};

  /// What the plan that holds at t adds to the motion.
  [[nodiscard]] double offset(double t) const noexcept {
    double sum = 0;
    for (const auto& [from, much] : offsets) sum = from <= t ? much : sum;
    return sum;
  }
};

/// One way in which a producer fails to deliver a motion in time.
struct Mishap {
  std::string_view name;
  std::string_view file;  ///< names its plot; empty: nothing happens that a plot could show
  Schedule (*make)(const Sines& motion, std::uint64_t seed);
  /// In rad: waypoints are multiples of it, as encoders give them; 0: they are not.
  double quantum = 0;
  bool is_covered = false;  ///< the lead covers it: nothing may be passed over behind the start
  /// Path errors that a simulation apart from this code has found, in rad: p99 and largest, with limits of 5, 10
  /// and 20 rad/s²; 0: none given.
  std::array<std::pair<double, double>, 3> simulated{};
};

[[nodiscard]] std::span<const Mishap> mishaps();

/// Waypoints at a rate in Hz, each sent `lead` s before its time.
[[nodiscard]] Schedule steady(const Motion& motion, double rate, double lead);

}  // namespace splinecast::campaign
