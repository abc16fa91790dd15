#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <string>

namespace splinecast::fuzz {

/// Counters of the processes of a byte-flip campaign, in memory that they share.
struct FlipCounters {
  std::atomic<bool> stop;  ///< the round is over: each process returns
  std::atomic<std::uint64_t> samples;
  std::atomic<std::uint64_t> with_values;
  std::atomic<std::uint64_t> not_numbers;  ///< samples with a value that is not finite
  std::atomic<std::uint64_t> snapshots;
  std::atomic<std::uint64_t> attached;  ///< readers that attached
  std::atomic<std::uint64_t> refused;   ///< readers that refused a damaged region
  std::atomic<std::uint64_t> reports;   ///< reports of `info`
  std::atomic<std::uint64_t> appended;
  std::atomic<std::uint64_t> revisions;
};

/// The processes of a round. Each returns true when `stop` is set, and false when it refuses a
/// damaged region with a documented exception.
bool produce_until_stopped(const std::string& stream, FlipCounters& counters);
bool solve_until_stopped(const std::string& stream, FlipCounters& counters);
bool read_until_stopped(const std::string& stream, std::uint64_t seed, FlipCounters& counters);

}  // namespace splinecast::fuzz
