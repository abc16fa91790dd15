#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>

#include "splinecast/time.hpp"

namespace splinecast::campaign {

/// Counters of the campaign of requests, in memory that its processes share.
struct RequestFacts {
  using Count = std::atomic<std::uint64_t>;

  // Requests that were in force, by kind.
  Count rates;
  Count holds;
  Count releases;
  Count dead_men;  ///< requests whose dead man has fired
  Count renewals;

  // Violations: each must be 0.
  Count lost;      ///< requests that were not in force after a minute
  Count not_held;  ///< holds after whose ramp the law moved
  Count revived;   ///< dead men that a renewal has ended
  Count exceeded;  ///< samples at which the rate exceeded a bound
  Count failed;    ///< processes that ended with an error

  // Work.
  Count samples;
  Count solvers_killed;
  Count solvers_stopped;
  Count commanders_killed;

  /// Notes the time from a request to the begin of its ramp.
  void note_effect(Time time) noexcept;

  /// Violations by name.
  [[nodiscard]] nlohmann::json found() const;
  /// Counters of the work, and the times to the effect, by name.
  [[nodiscard]] nlohmann::json measured() const;
  [[nodiscard]] std::uint64_t requests() const noexcept {
    return rates + holds + releases + dead_men + renewals;
  }

 private:
  static constexpr std::size_t kBuckets = 256;
  [[nodiscard]] Time quantile(double share) const noexcept;

  std::array<Count, kBuckets> effects_;  ///< eight per octave from 1 µs on
  std::atomic<std::int64_t> longest_;
};

}  // namespace splinecast::campaign
