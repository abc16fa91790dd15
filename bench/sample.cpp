#include <benchmark/benchmark.h>

#include <random>

#include "bench_stream.hpp"
#include "splinecast/ipc/reader.hpp"

namespace splinecast::bench {
namespace {

/// Position, velocity, acceleration and jerk at 1 kHz steps through 100 Hz knots, from shared
/// memory, through the public interface.
void sample(benchmark::State& bench) {
  const auto dimensions = static_cast<std::size_t>(bench.range(0));
  const Waypoints waypoints(4096, dimensions);
  const BenchStream stream(waypoints);
  ipc::Reader reader(stream.name());
  core::State state(dimensions);
  const core::Time last = waypoints.times.back();
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
  const Waypoints waypoints(65'536, dimensions);
  const BenchStream stream(waypoints);
  ipc::Reader reader(stream.name());
  core::State state(dimensions);
  std::mt19937_64 random(1);
  std::vector<core::Time> times(1U << 16U);
  for (core::Time& t : times) {
    t = core::Time(static_cast<std::int64_t>(
        random() % static_cast<std::uint64_t>(waypoints.times.back().count())));
  }
  std::size_t i = 0;
  for (auto _ : bench) {
    benchmark::DoNotOptimize(reader.sample(times[i++ % times.size()], state));
    benchmark::DoNotOptimize(state.values().data());
  }
}

BENCHMARK(sample)->ArgName("dims")->Arg(1)->Arg(3)->Arg(6)->Arg(7)->Arg(16)->Arg(32);
BENCHMARK(sample_random)->ArgName("dims")->Arg(7);

}  // namespace
}  // namespace splinecast::bench
