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

/// A call of a producer: appends waypoints, or replaces all waypoints from `replaces_from` on.
/// Times are in s.
struct Call {
  double at = 0;
  std::vector<double> times;
  std::vector<std::vector<double>> positions;  ///< [waypoint][joint]
  std::optional<double> replaces_from{};
};

/// Calls of a producer during a motion, and faults of the producer and of the solver. Times in s.
struct Schedule {
  std::vector<Call> calls;                          ///< sorted by `at`
  std::vector<std::pair<double, double>> pauses{};  ///< of the producer: from, until
  std::vector<std::pair<double, double>>
      deaths{};  ///< of the solver: from, until another one takes over
  /// Offsets of the plans from the motion: start time in s, offset in rad. Empty: no offset.
  std::vector<std::pair<double, double>> offsets{};
  std::optional<double> finish_at{};  ///< when the producer ends the stream

  /// The offset at t of the plan that is valid then.
  [[nodiscard]] double offset(double t) const noexcept {
    double sum = 0;
    for (const auto& [from, much] : offsets) sum = from <= t ? much : sum;
    return sum;
  }
};

/// A fault that keeps a motion from being delivered in time.
struct Fault {
  std::string_view name;
  std::string_view file;  ///< name of its plots; empty: no plot
  Schedule (*make)(const Sines& motion, std::uint64_t seed);
  /// Resolution of an encoder in rad: waypoints are rounded to multiples of it; 0: not rounded.
  double quantum = 0;
  bool is_covered = false;  ///< the lead covers it: after the start no waypoint may be passed over
  /// Path errors in rad that an independent simulation has found: p99 and largest, with limits of
  /// 5, 10 and 20 rad/s²; 0: unknown.
  std::array<std::pair<double, double>, 3> simulated{};
};

[[nodiscard]] std::span<const Fault> faults();

/// Waypoints at a rate in Hz, each sent `lead` s before its time.
[[nodiscard]] Schedule steady(const Motion& motion, double rate, double lead);

}  // namespace splinecast::campaign
