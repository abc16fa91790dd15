#include <benchmark/benchmark.h>

#include <map>
#include <random>

#include "bench_stream.hpp"
#include "random_times.hpp"
#include "splinecast/ipc/reader.hpp"

namespace splinecast::bench {
namespace {

struct Recorded {
  Waypoints waypoints;
  BenchStream stream;

  Recorded(std::size_t count, std::size_t dimensions)
      : waypoints(count, dimensions), stream(waypoints) {}
};

/// The streams are made once and stand until the end.
const Recorded& recorded(std::size_t count, std::size_t dimensions) {
  static std::map<std::pair<std::size_t, std::size_t>, Recorded> streams;
  return streams.try_emplace({count, dimensions}, count, dimensions).first->second;
}

/// Position, velocity, acceleration and jerk at 1 kHz steps through 100 Hz knots, from shared
/// memory, through the public interface.
void sample(benchmark::State& bench) {
  const auto dimensions = static_cast<std::size_t>(bench.range(0));
  const Recorded& from = recorded(4096, dimensions);
  ipc::Reader reader(from.stream.name());
  core::State state(dimensions);
  const core::Time last = from.waypoints.times.back();
  core::Time t{};
  for (auto _ : bench) {
    benchmark::DoNotOptimize(reader.sample(t, state));
    benchmark::DoNotOptimize(state.values().data());
    t += core::Time(1'000'000);
    if (t > last) t = core::Time{};
  }
}

/// The same at random times over 65,536 segments.
void sample_random(benchmark::State& bench) {
  const auto dimensions = static_cast<std::size_t>(bench.range(0));
  const Recorded& from = recorded(kRandomSegments, dimensions);
  ipc::Reader reader(from.stream.name());
  core::State state(dimensions);
  const std::vector<core::Time> times = random_times(from.waypoints.times.back());
  std::size_t i = 0;
  for (auto _ : bench) {
    benchmark::DoNotOptimize(reader.sample(times[i++ % times.size()], state));
    benchmark::DoNotOptimize(state.values().data());
  }
}

BENCHMARK(sample)->ArgName("dims")->Apply(all_dimensions);
BENCHMARK(sample_random)->ArgName("dims")->Arg(7);
/// For counting instructions: profile_paths.py divides by the iterations.
BENCHMARK(sample)->Name("counted/sample")->Arg(7)->Iterations(10'000);

}  // namespace
}  // namespace splinecast::bench
