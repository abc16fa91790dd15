#include <benchmark/benchmark.h>

#include <unistd.h>

#include "bench_stream.hpp"
#include "splinecast/core/sliding_window.hpp"
#include "splinecast/ipc/producer.hpp"
#include "splinecast/ipc/solver.hpp"
#include "splinecast/ipc/stream_files.hpp"

namespace splinecast::bench {
namespace {

/// Endless waypoints: the same ones again and again, with times that go on.
class Feed {
 public:
  explicit Feed(const Waypoints& waypoints) : waypoints_(waypoints) {}

  core::Waypoint next() {
    const std::size_t count = waypoints_.times.size();
    if (i_ == count) {
      i_ = 0;
      offset_ += waypoints_.times.back() + core::Time(10'000'000);
    }
    const std::span<const double> all(waypoints_.positions);
    const core::Waypoint waypoint{
        .time = offset_ + waypoints_.times[i_],
        .position = all.subspan(i_ * waypoints_.dimensions, waypoints_.dimensions)};
    ++i_;
    return waypoint;
  }

 private:
  const Waypoints& waypoints_;
  std::size_t i_ = 0;
  core::Time offset_{};
};

/// One waypoint through the window, all dimensions, after so many others.
void append(benchmark::State& bench) {
  const auto dimensions = static_cast<std::size_t>(bench.range(0));
  core::SlidingWindow window(dimensions, {.settle = static_cast<std::size_t>(bench.range(1))});
  const Waypoints waypoints(4096, dimensions);
  Feed feed(waypoints);
  core::Segment segment(dimensions);
  for (std::int64_t i = 0; i < bench.range(2); ++i) {
    const core::Waypoint waypoint = feed.next();
    window.append(waypoint);
  }
  for (auto _ : bench) {
    const core::Waypoint waypoint = feed.next();
    window.append(waypoint);
    window.segment(window.oldest_segment(), segment);
    benchmark::DoNotOptimize(segment.coefficients.data());
  }
}

/// One waypoint from producer to published segments, both roles in this process.
void publish(benchmark::State& bench) {
  const auto dimensions = static_cast<std::size_t>(bench.range(0));
  const Waypoints waypoints(4096, dimensions);
  Feed feed(waypoints);
  const std::string stream = "bench." + std::to_string(getpid());
  {
    ipc::Producer producer(
        stream, {.dimensions = dimensions, .clock = ipc::StreamClock::recorded, .start = {}});
    ipc::Solver solver(stream, {.wake = false});
    solver.attach();
    const ipc::MonotonicClock clock;
    for (auto _ : bench) {
      benchmark::DoNotOptimize(producer.append(feed.next()));
      solver.step(clock);
    }
  }
  ipc::remove_stream(stream);
}

BENCHMARK(append)
    ->ArgNames({"dims", "settle", "after"})
    ->Args({7, 8, 1'000})
    ->Args({7, 8, 10'000'000})
    ->Args({7, 16, 1'000})
    ->Args({32, 8, 1'000});
BENCHMARK(publish)->ArgName("dims")->Arg(7);

}  // namespace
}  // namespace splinecast::bench
