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

/// Binds this thread to a core while it lives; throws std::runtime_error where that is refused.
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
  /// The value that a share q of the trips does not exceed; there must be some.
  [[nodiscard]] double quantile(double q);
  /// p50 and p99, for `report`.
  [[nodiscard]] nlohmann::json summary();

 private:
  std::vector<std::int64_t> ns_;
};

/// What reading the clock twice costs: to be taken off what is timed alone.
[[nodiscard]] Time clock_cost();

/// Makes p50 the benchmark's time and p99 a counter. The benchmark has one iteration, which has
/// run.
void report(benchmark::State& bench, const nlohmann::json& summary);

/// Words that processes forked later share, a cache line and its neighbour each.
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
