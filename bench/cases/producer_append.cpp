#include <benchmark/benchmark.h>

#include <chrono>

#include "bench/harness/bench_stream.hpp"
#include "splinecast/producer.hpp"
#include "splinecast/solver.hpp"

namespace splinecast::bench {
namespace {

/// Waypoints that are appended before the solver empties the ring.
constexpr int kBatch = 512;

/// Measures `Producer::append` alone: the solver, in the same thread, consumes a batch of waypoints
/// outside of the measured time. The counter `appends` is the number of waypoints per iteration.
void producer_append(benchmark::State& bench) {
  const auto dimensions = static_cast<std::size_t>(bench.range(0));
  Feed feed(dimensions);
  const StreamName stream;
  Producer producer(stream,
                    {.dimensions = dimensions, .clock = StreamClock::recorded, .start = {}});
  Solver solver(stream, {.wake = false});
  solver.attach();
  const MonotonicClock clock;
  std::vector<Waypoint> waypoints(kBatch);
  for (auto _ : bench) {
    for (Waypoint& waypoint : waypoints) waypoint = feed.next();
    const auto begin = std::chrono::steady_clock::now();
    for (const Waypoint& waypoint : waypoints) {
      benchmark::DoNotOptimize(producer.append(waypoint));
    }
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
    bench.SetIterationTime(took.count());
    while (solver.step(clock).consumed > 0) {
    }
  }
  bench.counters["appends"] = kBatch;
}

BENCHMARK(producer_append)->ArgName("dims")->Arg(7)->UseManualTime();

}  // namespace
}  // namespace splinecast::bench
