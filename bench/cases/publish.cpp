#include <benchmark/benchmark.h>

#include <array>
#include <chrono>
#include <optional>
#include <thread>
#include <vector>

#include "apps/process/child.hpp"
#include "apps/process/signals.hpp"
#include "bench/harness/bench_stream.hpp"
#include "bench/harness/trips.hpp"
#include "splinecast/producer.hpp"
#include "splinecast/reader.hpp"
#include "splinecast/solver.hpp"

namespace splinecast::bench {
namespace {

/// Samples at settled_until() at 1 kHz until a stop is requested.
void poll_at_1_khz(const std::string& stream, std::atomic<std::uint64_t>& ready) {
  Reader reader(stream);
  State state(reader.dimensions());
  ready.fetch_add(1);
  const MonotonicClock clock;
  for (Time next = clock.now(); apps::sleep_until(next); next += Time(1'000'000)) {
    benchmark::DoNotOptimize(reader.sample(reader.settled_until(), state));
  }
}

/// For a child process: runs this many readers on the far core, one thread each.
nlohmann::json poll_with(std::size_t readers, const std::string& stream, const SharedLines& ready) {
  const Pinned pin(kFar);
  std::vector<std::thread> threads;
  for (std::size_t i = 0; i < readers; ++i) {
    threads.emplace_back(poll_at_1_khz, std::cref(stream), std::ref(ready[0]));
  }
  for (std::thread& thread : threads) thread.join();
  return nullptr;
}

/// Measures one waypoint from the append to the published knots. Producer and solver run in this
/// process, while readers in another one poll at 1 kHz.
void publish(benchmark::State& bench) {
  const auto dimensions = static_cast<std::size_t>(bench.range(0));
  const auto readers = static_cast<std::size_t>(bench.range(1));
  const Pinned pin(kNear);
  Feed feed(dimensions);
  const StreamName stream;
  Producer producer(stream,
                    {.dimensions = dimensions, .clock = StreamClock::recorded, .start = {}});
  Solver solver(stream, {.wake = false});
  solver.attach();
  const MonotonicClock clock;
  const auto append = [&] {
    benchmark::DoNotOptimize(producer.append(feed.next()));
    solver.step(clock);
  };
  append();
  const SharedLines ready;
  std::optional<apps::Child> polling;
  if (readers > 0) polling.emplace([&] { return poll_with(readers, stream, ready); });
  while (ready[0].load() < readers) std::this_thread::yield();
  for (auto _ : bench) append();
  if (polling) {
    polling->stop();
    polling->result();
  }
}

BENCHMARK(publish)->ArgNames({"dims", "readers"})->ArgsProduct({{7}, {0, 1, 16, 64}});
BENCHMARK(publish)->ArgNames({"dims", "readers"})->ArgsProduct({{1, 3, 6, 16, 32}, {0}});
/// For counting instructions: profile_paths.py divides by the iterations.
BENCHMARK(publish)->Name("counted/publish")->Args({7, 0})->Iterations(10'000);

}  // namespace
}  // namespace splinecast::bench
