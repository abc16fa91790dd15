#include <benchmark/benchmark.h>

#include <boost/math/interpolators/makima.hpp>
#include <vector>

#include "bench/harness/bench_stream.hpp"

/// Boost.Math's modified Akima interpolator, to which single points can be appended. It is C¹ only;
/// an append changes only the last two slopes.
namespace splinecast::bench {
namespace {

using Makima = boost::math::interpolators::makima<std::vector<double>>;

constexpr std::size_t kFirst = 1'000;
constexpr std::size_t kMost = 65'536;

/// One interpolator per dimension over the first waypoints, with reserved capacity: reallocation is
/// not measured.
std::vector<Makima> make(Feed& feed, std::size_t dimensions) {
  std::vector<double> x;
  std::vector<std::vector<double>> y(dimensions);
  x.reserve(kMost);
  for (auto& values : y) values.reserve(kMost);
  for (std::size_t i = 0; i < kFirst; ++i) {
    const Waypoint waypoint = feed.next();
    x.push_back(to_seconds(waypoint.time));
    for (std::size_t d = 0; d < dimensions; ++d) y[d].push_back(waypoint.position[d]);
  }
  std::vector<Makima> all;
  for (std::size_t d = 0; d < dimensions; ++d) {
    std::vector<double> times;
    times.reserve(kMost);
    times = x;
    all.emplace_back(std::move(times), std::move(y[d]));
  }
  return all;
}

/// Appends one waypoint to all dimensions.
void append(benchmark::State& bench) {
  const auto dimensions = static_cast<std::size_t>(bench.range(0));
  Feed feed(dimensions);
  std::vector<Makima> all = make(feed, dimensions);
  std::size_t points = kFirst;
  for (auto _ : bench) {
    const Waypoint waypoint = feed.next();
    const double t = to_seconds(waypoint.time);
    for (std::size_t d = 0; d < dimensions; ++d) all[d].push_back(t, waypoint.position[d]);
    benchmark::ClobberMemory();
    if (++points < kMost) continue;
    bench.PauseTiming();
    all = make(feed, dimensions);
    points = kFirst;
    bench.ResumeTiming();
  }
}

BENCHMARK(append)->Name("makima/append")->ArgName("dims")->Apply(all_dimensions);

}  // namespace
}  // namespace splinecast::bench
