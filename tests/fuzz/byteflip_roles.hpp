#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <string>

namespace splinecast::fuzz {

/// What the processes of a byte-flip campaign count, in memory that they share.
struct FlipCounters {
  std::atomic<bool> stop;  ///< the round is over: leave
  std::atomic<std::uint64_t> samples;
  std::atomic<std::uint64_t> with_values;
  std::atomic<std::uint64_t> not_numbers;  ///< samples with values of which one is no number
  std::atomic<std::uint64_t> snapshots;
  std::atomic<std::uint64_t> attached;  ///< readers that attached
  std::atomic<std::uint64_t> refused;   ///< readers that a damaged region has been refused to
  std::atomic<std::uint64_t> reports;   ///< looks by `info`
  std::atomic<std::uint64_t> appended;
  std::atomic<std::uint64_t> revisions;
};

/// The processes of a round. Each returns when `stop` is set, or when a damaged region has been
/// refused to it as the roles document: then `false`.
bool produce_until_stopped(const std::string& stream, FlipCounters& counters);
bool solve_until_stopped(const std::string& stream, FlipCounters& counters);
bool read_until_stopped(const std::string& stream, std::uint64_t seed, FlipCounters& counters);

}  // namespace splinecast::fuzz
