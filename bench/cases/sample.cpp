#include <benchmark/benchmark.h>

#include <array>
#include <map>
#include <span>

#include "bench/harness/bench_stream.hpp"
#include "bench/harness/random_times.hpp"
#include "splinecast/reader.hpp"

namespace splinecast::bench {
namespace {

struct Recorded {
  Waypoints waypoints;
  BenchStream stream;

  Recorded(std::size_t count, std::size_t dimensions)
      : waypoints(count, dimensions), stream(waypoints) {}
};

/// Returns the stream of this size. Creates it at the first call and keeps it until the end.
const Recorded& recorded(std::size_t count, std::size_t dimensions) {
  static std::map<std::pair<std::size_t, std::size_t>, Recorded> streams;
  return streams.try_emplace({count, dimensions}, count, dimensions).first->second;
}

/// Measures one sample of position, velocity, acceleration and jerk through the public `Reader`.
/// The times are 1 ms apart, the knots about 10 ms.
void sample(benchmark::State& bench) {
  const auto dimensions = static_cast<std::size_t>(bench.range(0));
  const Recorded& from = recorded(4096, dimensions);
  Reader reader(from.stream.name());
  State state(dimensions);
  const Time last = from.waypoints.times.back();
  Time t{};
  for (auto _ : bench) {
    benchmark::DoNotOptimize(reader.sample(t, state));
    benchmark::DoNotOptimize(state.values().data());
    t += Time(1'000'000);
    if (t > last) t = Time{};
  }
}

/// The same at random times over 65,536 segments.
void sample_random(benchmark::State& bench) {
  const auto dimensions = static_cast<std::size_t>(bench.range(0));
  const Recorded& from = recorded(kRandomSegments, dimensions);
  Reader reader(from.stream.name());
  State state(dimensions);
  const std::vector<Time> times = random_times(from.waypoints.times.back());
  std::size_t i = 0;
  for (auto _ : bench) {
    benchmark::DoNotOptimize(reader.sample(times[i++ % times.size()], state));
    benchmark::DoNotOptimize(state.values().data());
  }
}

/// Two lists of times 2 ms apart; the second list is 1 ms later. Even calls sample a part of the
/// first list, odd calls a part of the second, as a predictive controller at 1 kHz does.
std::array<std::vector<Time>, 2> horizons_until(Time end) {
  constexpr Time kApart{2'000'000};
  std::array<std::vector<Time>, 2> times;
  for (Time t{}; t + kApart / 2 <= end; t += kApart) {
    times[0].push_back(t);
    times[1].push_back(t + kApart / 2);
  }
  return times;
}

/// Measures one call that samples many times of a finished stream: the horizon of a predictive
/// controller. The counter `times` is the number of times per call.
void sample_many(benchmark::State& bench) {
  const auto dimensions = static_cast<std::size_t>(bench.range(0));
  const auto count = static_cast<std::size_t>(bench.range(1));
  const Recorded& from = recorded(4096, dimensions);
  Reader reader(from.stream.name());
  std::vector<double> values(count * State(dimensions).values().size());
  std::vector<SampleStatus> status(count);
  const auto times = horizons_until(from.waypoints.times.back());
  const std::size_t calls = 2 * (times[0].size() - count);
  std::size_t i = 0;
  for (auto _ : bench) {
    const auto horizon = std::span(times[i % 2]).subspan(i / 2, count);
    benchmark::DoNotOptimize(reader.sample_many(horizon, {.values = values, .status = status}));
    benchmark::ClobberMemory();
    i = i + 1 < calls ? i + 1 : 0;
  }
  for (const SampleStatus one : status) {
    if (!has_values(one)) bench.SkipWithError("a time of a horizon had no values");
  }
  bench.counters["times"] = static_cast<double>(count);
}

BENCHMARK(sample)->ArgName("dims")->Apply(all_dimensions);
BENCHMARK(sample_many)->ArgNames({"dims", "times"})->Args({7, 50});
/// For comparison with Python: bench/python/overhead.py.
BENCHMARK(sample_many)->Name("horizon")->ArgNames({"dims", "times"})->Args({7, 1000});
BENCHMARK(sample_random)->ArgName("dims")->Arg(7);
/// For counting instructions: profile_paths.py divides by the iterations.
BENCHMARK(sample)->Name("counted/sample")->Arg(7)->Iterations(10'000);

}  // namespace
}  // namespace splinecast::bench
