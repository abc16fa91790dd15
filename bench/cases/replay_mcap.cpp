#include <benchmark/benchmark.h>

#include "apps/replay/player.hpp"
#include "bench/harness/bench_stream.hpp"
#include "bench/harness/mcap_recording.hpp"

namespace splinecast::bench {
namespace {

/// An MCAP file to settled segments in shared memory, as `replay --embedded --rate max` does it.
void replay(benchmark::State& bench, McapRecording::Kind kind) {
  const McapRecording file(kind);
  const StreamName stream;
  apps::ReplayOptions options{.file = file.path(),
                              .table = {.quiet = true},
                              .stream = stream,
                              .rate = {},
                              .ring = {.clock = StreamClock::recorded},
                              .embedded = true,
                              .quiet = true};
  for (auto _ : bench) {
    apps::RefusedRows refused;
    apps::Recording recording = apps::open_recording(options, refused);
    const apps::ReplayReport report = apps::replay_recording(recording, options, refused);
    if (report.interpolated != McapRecording::kRows) bench.SkipWithError("waypoints were lost");
  }
  const auto runs = static_cast<std::int64_t>(bench.iterations());
  bench.SetItemsProcessed(runs * static_cast<std::int64_t>(McapRecording::kRows));
  bench.SetBytesProcessed(runs * static_cast<std::int64_t>(file.bytes()));
}

BENCHMARK_CAPTURE(replay, joint_states, McapRecording::Kind::joint_states)
    ->Name("replay/mcap:joint_states/dims:7")
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(replay, recorded_stream, McapRecording::Kind::recorded_stream)
    ->Name("replay/mcap:recorded_stream/dims:7")
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace splinecast::bench
