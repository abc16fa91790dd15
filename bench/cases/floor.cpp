#include <benchmark/benchmark.h>

#include <vector>

#include "bench/harness/bench_stream.hpp"
#include "core/polynomial/segment.hpp"
#include "splinecast/state.hpp"

namespace splinecast::bench {
namespace {

/// The lower bound of a sample: the same polynomial from this process's own memory, without a
/// lookup.
void floor_eval(benchmark::State& bench) {
  const auto dimensions = static_cast<std::size_t>(bench.range(0));
  const std::vector<double> coefficients(4 * dimensions, 0.25);
  State state(dimensions);
  double u = 0;
  for (auto _ : bench) {
    core::evaluate(kCubicOrder, coefficients, u, state.ref());
    benchmark::DoNotOptimize(state.values().data());
    u += 1e-9;
  }
}

BENCHMARK(floor_eval)->Name("floor/eval")->ArgName("dims")->Apply(all_dimensions);

}  // namespace
}  // namespace splinecast::bench
