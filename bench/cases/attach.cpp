#include <benchmark/benchmark.h>

#include <optional>
#include <stdexcept>

#include "apps/process/child.hpp"
#include "bench/harness/bench_stream.hpp"
#include "bench/harness/trips.hpp"
#include "bench/harness/writer.hpp"
#include "ipc/roles/internals.hpp"
#include "splinecast/reader.hpp"

namespace splinecast::bench {
namespace {

constexpr std::size_t kAttachments = 500;

/// The newest settled time of a stream.
Time settled_until(const std::string& stream) {
  Reader reader(stream);
  State state(kWrittenDimensions);
  (void)reader.sample(Time{}, state);
  return reader.settled_until();
}

/// The time from attaching to another process's stream to the first sample.
void attach(benchmark::State& bench) {
  const Pinned pin(kNear);
  const StreamName stream;
  const SharedLines lines;
  for (auto _ : bench) {
    apps::Child writer([&] { return write_stream(stream, kWrittenKnots, std::nullopt, lines[0]); });
    await(lines[0], 1);
    const Time t = settled_until(stream);
    const MonotonicClock clock;
    State state(kWrittenDimensions);
    Trips attachments(kAttachments);
    for (std::size_t i = 0; i < kAttachments; ++i) {
      const Time start = clock.now();
      Reader reader(stream);
      const SampleStatus status = reader.sample(t, state);
      attachments.add(clock.now() - start);
      if (!has_values(status)) throw std::runtime_error("a first sample had no values");
    }
    report(bench, attachments.summary());
    writer.stop();
    writer.result();
  }
}

/// The size of the region that the solver writes.
void board_bytes(benchmark::State& bench) {
  const Waypoints waypoints(kWrittenKnots, kWrittenDimensions);
  const BenchStream stream(waypoints);
  const Reader reader(stream.name());
  for (auto _ : bench) benchmark::DoNotOptimize(ipc::Internals::header(reader));
  bench.counters["region_bytes"] = static_cast<double>(ipc::Internals::header(reader).region_bytes);
}

BENCHMARK(attach)->Name("attach/dims:7/knots:4096")->Iterations(1)->UseManualTime();
BENCHMARK(board_bytes)->Name("board/dims:7/knots:4096")->Iterations(1);

}  // namespace
}  // namespace splinecast::bench
