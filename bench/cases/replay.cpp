#include <benchmark/benchmark.h>

#include "apps/replay/player.hpp"
#include "apps/tables/waypoints.hpp"
#include "bench/harness/bench_stream.hpp"
#include "bench/harness/csv_recording.hpp"

namespace splinecast::bench {
namespace {

void count(benchmark::State& bench, std::size_t per_iteration_bytes) {
  const auto runs = static_cast<std::int64_t>(bench.iterations());
  bench.SetItemsProcessed(runs * static_cast<std::int64_t>(CsvRecording::kRows));
  bench.SetBytesProcessed(runs * static_cast<std::int64_t>(per_iteration_bytes));
}

/// CSV text to a table.
void parse(benchmark::State& bench) {
  const std::string path = csv_recording().path();
  for (auto _ : bench) benchmark::DoNotOptimize(apps::read_waypoints(path, {}).positions.data());
  count(bench, csv_recording().bytes());
}

/// CSV text to settled segments in shared memory, as `replay --embedded --rate max` does it.
void replay(benchmark::State& bench) {
  const StreamName stream;
  apps::ReplayOptions options{.file = csv_recording().path(),
                              .stream = stream,
                              .rate = {},
                              .ring = {.clock = StreamClock::recorded},
                              .embedded = true,
                              .quiet = true};
  for (auto _ : bench) {
    apps::RefusedRows refused;
    apps::Recording recording = apps::open_recording(options, refused);
    const apps::ReplayReport report = apps::replay_recording(recording, options, refused);
    if (report.interpolated != CsvRecording::kRows) bench.SkipWithError("waypoints were lost");
  }
  count(bench, csv_recording().bytes());
}

BENCHMARK(parse)->Name("parse/dims:7")->Unit(benchmark::kMillisecond);
BENCHMARK(replay)->Name("replay/dims:7")->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace splinecast::bench
