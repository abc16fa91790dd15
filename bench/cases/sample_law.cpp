#include <benchmark/benchmark.h>

#include <map>

#include "bench/harness/bench_stream.hpp"
#include "bench/harness/law_stream.hpp"
#include "splinecast/clock.hpp"
#include "splinecast/reader.hpp"

namespace splinecast::bench {
namespace {

constexpr std::size_t kSegments = 4096;

/// The stream of this many dimensions. Creates it at the first call and keeps it until the end.
const LawStream& followed(std::size_t dimensions) {
  static std::map<std::size_t, LawStream> streams;
  return streams.try_emplace(dimensions, Waypoints(kSegments, dimensions)).first->second;
}

/// Measures one sample of a stream that follows a law, as `sample` does without one. The times are
/// 1 ms of stream time apart. Law and curve have settled.
void sample_law(benchmark::State& bench) {
  const auto dimensions = static_cast<std::size_t>(bench.range(0));
  const LawStream& from = followed(dimensions);
  Reader reader(from.name());
  State state(dimensions);
  constexpr Time kApart(static_cast<Time::rep>(1e6 / LawStream::kRate));
  Time t = from.begin();
  for (auto _ : bench) {
    benchmark::DoNotOptimize(reader.sample(t, state));
    benchmark::DoNotOptimize(state.values().data());
    t += kApart;
    if (t > from.end()) t = from.begin();
  }
  if (reader.sample(from.begin(), state) != SampleStatus::settled || reader.rate().rate == 1) {
    bench.SkipWithError("the stream does not follow the law");
  }
}

BENCHMARK(sample_law)->ArgName("dims")->Apply(all_dimensions);
/// For counting instructions: profile_paths.py divides by the iterations.
BENCHMARK(sample_law)->Name("counted/sample_law")->Arg(7)->Iterations(10'000);

}  // namespace
}  // namespace splinecast::bench
