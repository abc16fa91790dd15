#pragma once

#include <benchmark/benchmark.h>

#include <atomic>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <vector>

#include "splinecast/time.hpp"

/// Single trips, measured one by one, between processes on two cores.
namespace splinecast::bench {

/// The cores that floors, peers and subjects share: the one that measures, and the other one.
inline constexpr int kNear = 0;
inline constexpr int kFar = 1;

/// Pins this thread to a core for the lifetime of the object; throws std::runtime_error if that
/// fails.
class Pinned {
 public:
  explicit Pinned(int core);
  Pinned(const Pinned&) = delete;
  Pinned& operator=(const Pinned&) = delete;
  ~Pinned();

 private:
  cpu_set_t before_{};
};

/// Times of single trips in ns.
class Trips {
 public:
  explicit Trips(std::size_t count) { ns_.reserve(count); }
  void add(Time trip) { ns_.push_back(trip.count()); }
  [[nodiscard]] std::size_t size() const { return ns_.size(); }
  /// The q-quantile of the trips. Requires at least one trip.
  [[nodiscard]] double quantile(double q);
  /// p50 and p99, for `report`.
  [[nodiscard]] nlohmann::json summary();

 private:
  std::vector<std::int64_t> ns_;
};

/// The median cost of reading the clock twice, to subtract from single timings.
[[nodiscard]] Time clock_cost();

/// Sets p50 as the benchmark's time and all values of the summary as counters. Requires a benchmark
/// with one iteration, which has run.
void report(benchmark::State& bench, const nlohmann::json& summary);

/// Words in memory shared with processes that are forked later, each on its own pair of cache
/// lines.
class SharedLines {
 public:
  static constexpr std::size_t kLines = 4;
  SharedLines();
  SharedLines(const SharedLines&) = delete;
  SharedLines& operator=(const SharedLines&) = delete;
  ~SharedLines();
  [[nodiscard]] std::atomic<std::uint64_t>& operator[](std::size_t line) const;

 private:
  struct alignas(128) Line {
    std::atomic<std::uint64_t> word;
  };
  Line* lines_;
};

/// Spins, without a pause, until the word is `wanted`. Returns false if a stop is requested.
bool await(const std::atomic<std::uint64_t>& word, std::uint64_t wanted);

}  // namespace splinecast::bench
