#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>

#include "splinecast/time.hpp"

namespace splinecast::campaign {

/// A request that takes longer is lost, also on a busy machine.
inline constexpr Time kLongestRequest = std::chrono::minutes(1);

/// A histogram of times, in memory that processes share.
class SharedTimes {
 public:
  void note(Time time) noexcept;
  /// The upper end of the bucket in which this share of the times ends.
  [[nodiscard]] Time quantile(double share) const noexcept;
  [[nodiscard]] Time longest() const noexcept { return Time(longest_.load()); }

 private:
  static constexpr std::size_t kBuckets = 256;

  std::array<std::atomic<std::uint64_t>, kBuckets> counts_;  ///< eight per octave from 1 µs on
  std::atomic<std::int64_t> longest_;
};

/// Counters of the campaign of requests, in memory that its processes share.
struct RequestFacts {
  using Count = std::atomic<std::uint64_t>;

  // Requests that were in force, by kind.
  Count rates;
  Count holds;
  Count releases;
  Count dead_men;  ///< requests whose dead man has fired
  Count renewals;
  Count stops;
  Count stops_released;
  Count stops_left;  ///< by stoppers that were killed; their successors found them in force

  // Violations: each must be 0.
  Count lost;              ///< requests that were not in force after a minute
  Count not_held;          ///< holds after whose ramp the law moved
  Count revived;           ///< dead men that a renewal has ended
  Count exceeded;          ///< samples at which the rate exceeded a bound
  Count failed;            ///< processes that ended with an error
  Count lost_stops;        ///< stops and releases that were not in force after a minute
  Count moved_while_held;  ///< samples of a machine that moved although a stopper held it

  // Work.
  Count samples;
  Count solvers_killed;
  Count solvers_stopped;
  Count commanders_killed;
  Count stoppers_killed;
  Count looks_at_rest;    ///< samples of a machine that a stopper held
  Count appends_stopped;  ///< waypoints that the producer got back as `stopped`
  Count streams_created;

  SharedTimes effects;  ///< from a request to the begin of its ramp
  SharedTimes stopped;  ///< from a stop to the commit that makes it in force

  /// Violations by name.
  [[nodiscard]] nlohmann::json found() const;
  /// Counters of the work, and the times to the effect, by name.
  [[nodiscard]] nlohmann::json measured() const;
  [[nodiscard]] std::uint64_t requests() const noexcept {
    return rates + holds + releases + dead_men + renewals + stops + stops_released;
  }
};

}  // namespace splinecast::campaign
