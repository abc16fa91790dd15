#include <benchmark/benchmark.h>

#include "bench/harness/bench_stream.hpp"
#include "core/online/sliding_window.hpp"

namespace splinecast::bench {
namespace {

/// A window with an endless feed of waypoints.
class FedWindow {
 public:
  FedWindow(std::size_t dimensions, std::size_t settle, std::int64_t fed)
      : feed_(dimensions), window_(dimensions, {.settle = settle}), segment_(dimensions) {
    for (std::int64_t i = 0; i < fed; ++i) window_.append(feed_.next());
  }

  /// Appends one waypoint in all dimensions, and gets the segment that it settles.
  void append() {
    window_.append(feed_.next());
    window_.segment(window_.oldest_segment(), segment_);
    benchmark::DoNotOptimize(segment_.coefficients.data());
  }

 private:
  Feed feed_;
  core::SlidingWindow window_;
  core::Segment segment_;
};

void append(benchmark::State& bench) {
  constexpr std::int64_t kBefore = 1'000;
  FedWindow window(static_cast<std::size_t>(bench.range(0)),
                   static_cast<std::size_t>(bench.range(1)), kBefore);
  for (auto _ : bench) window.append();
}

/// The same after ten million waypoints. All blocks use the same window.
void append_late(benchmark::State& bench) {
  static FedWindow window(7, 8, 10'000'000);
  for (auto _ : bench) window.append();
}

BENCHMARK(append)->ArgNames({"dims", "settle"})->ArgsProduct({{1, 3, 6, 7, 16, 32}, {8, 16}});
BENCHMARK(append_late)->Name("append/dims:7/settle:8/after:10000000");

}  // namespace
}  // namespace splinecast::bench
