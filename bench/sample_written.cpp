#include <benchmark/benchmark.h>

#include <algorithm>
#include <optional>
#include <stdexcept>

#include "bench_stream.hpp"
#include "splinecast/ipc/producer.hpp"
#include "splinecast/ipc/reader.hpp"
#include "splinecast/ipc/solver.hpp"
#include "support/child.hpp"
#include "support/signals.hpp"
#include "trips.hpp"

namespace splinecast::bench {
namespace {

constexpr std::size_t kDimensions = 7;
constexpr std::size_t kKnots = 4096;
constexpr std::size_t kSamples = 2'000'000;
constexpr core::Time kStep{1'000'000};
constexpr core::Time kPatience{10'000'000'000};

/// Publishes a stream of kKnots waypoints, and then goes on at a rate, or not at all.
nlohmann::json write_stream(const std::string& stream, std::int64_t rate,
                            std::atomic<std::uint64_t>& ready) {
  const Pinned pin(kFar);
  Feed feed(kDimensions);
  ipc::Producer producer(
      stream, {.dimensions = kDimensions, .clock = ipc::StreamClock::recorded, .start = {}});
  ipc::Solver solver(stream, {.capacity = 2 * kKnots, .wake = false});
  solver.attach();
  const ipc::MonotonicClock clock;
  const auto publish = [&] {
    if (producer.append(feed.next()) != ipc::AppendStatus::accepted) {
      throw std::runtime_error("a waypoint was refused");
    }
    solver.step(clock);
  };
  for (std::size_t i = 0; i < kKnots; ++i) publish();
  ready.store(1, std::memory_order_release);
  const core::Time period = rate > 0 ? core::Time(1'000'000'000 / rate) : kPatience;
  core::Time next = clock.now() + period;
  for (; apps::sleep_until(next); next += period) publish();
  return nullptr;
}

/// What reading the clock twice costs: taken off each sample.
core::Time clock_cost() {
  const ipc::MonotonicClock clock;
  constexpr std::size_t kPairs = 10'001;
  Trips pairs(kPairs);
  for (std::size_t i = 0; i < kPairs; ++i) {
    const core::Time start = clock.now();
    pairs.add(clock.now() - start);
  }
  return core::Time(static_cast<std::int64_t>(pairs.quantile(0.5)));
}

/// Samples at 1 kHz steps, again and again, from 20 s before what is settled to behind the newest
/// knot; each sample is timed alone.
nlohmann::json sample_all(const std::string& stream) {
  ipc::Reader reader(stream, kPatience);
  core::State state(kDimensions);
  const ipc::MonotonicClock clock;
  const core::Time cost = clock_cost();
  Trips all(kSamples);
  Trips first_of_revision(kSamples);
  (void)reader.sample(core::Time{}, state);  // what is settled is known by now
  core::Time t{};
  core::Time last{};
  for (std::size_t i = 0; i < kSamples; ++i, t += kStep) {
    if (t >= last) {
      t = reader.settled_until() - core::Time(20'000'000'000);
      last = reader.settled_until() + core::Time(100'000'000);
    }
    const ipc::Word seen = reader.sampler().revision_seen();
    const core::Time start = clock.now();
    const ipc::SampleStatus status = reader.sample(t, state);
    const core::Time took = clock.now() - start - cost;
    if (!ipc::has_values(status)) throw std::runtime_error("a sample had no values");
    all.add(took);
    if (reader.sampler().revision_seen() != seen) first_of_revision.add(took);
  }
  nlohmann::json summary = all.summary();
  if (!first_of_revision.empty()) {
    summary["new_revision_p50_ns"] = first_of_revision.quantile(0.5);
  }
  return summary;
}

/// A sample while another process publishes.
void sample_written(benchmark::State& bench, std::int64_t rate) {
  const Pinned pin(kNear);
  const StreamName stream;
  const SharedLines lines;
  for (auto _ : bench) {
    apps::Child writer([&] { return write_stream(stream, rate, lines[0]); });
    await(lines[0], 1);
    report(bench, sample_all(stream));
    writer.stop();
    writer.result();
  }
}

BENCHMARK_CAPTURE(sample_written, quiet, 0)
    ->Name("sample/dims:7/writer:quiet")
    ->Iterations(1)
    ->UseManualTime();
BENCHMARK_CAPTURE(sample_written, slow, 100)
    ->Name("sample/dims:7/writer:100Hz")
    ->Iterations(1)
    ->UseManualTime();
BENCHMARK_CAPTURE(sample_written, fast, 1000)
    ->Name("sample/dims:7/writer:1kHz")
    ->Iterations(1)
    ->UseManualTime();

}  // namespace
}  // namespace splinecast::bench
