#include <benchmark/benchmark.h>

#include <array>
#include <functional>

#include "apps/process/child.hpp"
#include "apps/replay/player.hpp"
#include "apps/tables/waypoints.hpp"
#include "bench/harness/bench_stream.hpp"
#include "bench/harness/csv_recording.hpp"
#include "bench/harness/trips.hpp"
#include "bench/harness/writer.hpp"
#include "ipc/roles/internals.hpp"
#include "splinecast/reader.hpp"

/// Samples while another process writes the board as fast as possible.
namespace splinecast::bench {
namespace {

constexpr std::size_t kSamples = 1'000'000;
constexpr Time kPatience{10'000'000'000};

/// `replay --embedded --rate max` on the far core, until a stop is requested.
nlohmann::json replay_until_stopped(const std::string& stream) {
  const Pinned pin(kFar);
  apps::ReplayOptions options{.file = csv_recording().path(),
                              .stream = stream,
                              .rate = {},
                              .loops = 1'000'000,
                              .ring = {.clock = StreamClock::recorded},
                              .embedded = true,
                              .quiet = true};
  apps::RefusedRows refused;
  apps::Recording recording = apps::open_recording(options, refused);
  (void)apps::replay_recording(recording, options, refused);
  return nullptr;
}

/// Samples the segments that a revision changes, in turn, and times every sample separately.
nlohmann::json sample_open_segments(const std::string& stream) {
  constexpr std::size_t kSegments = 8;
  constexpr Time kInterval{10'000'000};
  Reader reader(stream, kPatience);
  State state(kWrittenDimensions);
  const MonotonicClock clock;
  const Time cost = clock_cost();
  while (!has_values(reader.preview(reader.settled_until(), state))) {
  }
  Trips all(kSamples);
  std::array<std::size_t, kSampleStatuses> by_status{};
  std::size_t revisions = 0;
  for (std::size_t i = 0; i < kSamples; ++i) {
    const ipc::Word seen = ipc::Internals::sampler(reader).revision_seen();
    const auto segment = static_cast<int>(i % kSegments);
    const Time start = clock.now();
    const SampleStatus status = reader.preview(reader.settled_until() + segment * kInterval, state);
    all.add(clock.now() - start - cost);
    ++by_status[static_cast<std::size_t>(status)];
    if (ipc::Internals::sampler(reader).revision_seen() != seen) ++revisions;
  }
  nlohmann::json summary = all.summary();
  const auto share = [](std::size_t count) { return static_cast<double>(count) / kSamples; };
  const auto share_with = [&](SampleStatus status) {
    return share(by_status[static_cast<std::size_t>(status)]);
  };
  summary["busy_share"] = share_with(SampleStatus::busy);
  summary["before_history_share"] = share_with(SampleStatus::before_history);
  summary["new_revision_share"] = share(revisions);
  return summary;
}

void sample_overtaken(benchmark::State& bench,
                      const std::function<nlohmann::json(
                          const std::string& stream, std::atomic<std::uint64_t>& ready)>& write) {
  (void)csv_recording();  // created by this process, which removes it
  const Pinned pin(kNear);
  const StreamName stream;
  const SharedLines lines;
  for (auto _ : bench) {
    apps::Child writer([&] { return write(stream, lines[0]); });
    report(bench, sample_open_segments(stream));
    writer.stop();
    writer.result();
  }
}

BENCHMARK_CAPTURE(sample_overtaken, replay,
                  [](const std::string& stream, std::atomic<std::uint64_t>&) {
                    return replay_until_stopped(stream);
                  })
    ->Name("sample/dims:7/beside:replay")
    ->Iterations(1)
    ->UseManualTime();
/// The same with one revision per waypoint: the case in which readers are overtaken most often.
BENCHMARK_CAPTURE(sample_overtaken, publish,
                  [](const std::string& stream, std::atomic<std::uint64_t>& ready) {
                    return write_stream(stream, kWrittenKnots, Time::zero(), ready);
                  })
    ->Name("sample/dims:7/beside:publish")
    ->Iterations(1)
    ->UseManualTime();

}  // namespace
}  // namespace splinecast::bench
