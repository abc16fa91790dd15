#include <benchmark/benchmark.h>

#include <chrono>
#include <ctime>
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

constexpr std::size_t kSamples = 2'000'000;
/// The minimum number of samples in a run that are the first of a new revision.
constexpr std::size_t kFirstSamples = 100;
constexpr Time kPatience{10'000'000'000};

/// Samples in steps of 1 ms from 20 s before settled_until() to after the newest knot, repeatedly.
class Walk {
 public:
  explicit Walk(const std::string& stream) : reader_(stream, kPatience) {
    (void)reader_.sample(Time{}, state_);  // so that settled_until() is known
  }

  /// Advances to the time of the next sample.
  void step() {
    t_ += Time(1'000'000);
    if (t_ < end_) return;
    t_ = reader_.settled_until() - Time(20'000'000'000);
    end_ = reader_.settled_until() + Time(100'000'000);
  }
  [[nodiscard]] SampleStatus sample() { return reader_.sample(t_, state_); }
  [[nodiscard]] ipc::Word revision_seen() {
    return ipc::Internals::sampler(reader_).revision_seen();
  }

 private:
  Reader reader_;
  State state_{kWrittenDimensions};
  Time t_{};
  Time end_{};
};

void require_values(SampleStatus status) {
  if (!has_values(status)) throw std::runtime_error("a sample had no values");
}

/// CPU time of this thread.
Time cpu_now() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return std::chrono::seconds(now.tv_sec) + std::chrono::nanoseconds(now.tv_nsec);
}

/// Mean CPU time of a sample [ns]. The clock is too coarse to time a single one.
double mean_time(Walk& walk) {
  const Time start = cpu_now();
  for (std::size_t i = 0; i < kSamples; ++i) {
    walk.step();
    require_values(walk.sample());
  }
  return static_cast<double>((cpu_now() - start).count()) / kSamples;
}

/// Times every sample separately. If the stream `is_written` at the same time, also reports the p50
/// of the samples that found a new revision.
nlohmann::json time_alone(Walk& walk, bool is_written) {
  const MonotonicClock clock;
  const Time cost = clock_cost();
  Trips all(kSamples);
  Trips first_of_revision(kFirstSamples);
  while (all.size() < kSamples || (is_written && first_of_revision.size() < kFirstSamples)) {
    walk.step();
    const ipc::Word seen = walk.revision_seen();
    const Time start = clock.now();
    const SampleStatus status = walk.sample();
    const Time took = clock.now() - start - cost;
    require_values(status);
    if (all.size() < kSamples) all.add(took);
    if (walk.revision_seen() != seen) first_of_revision.add(took);
  }
  nlohmann::json summary = all.summary();
  if (is_written) summary["new_revision_p50_ns"] = first_of_revision.quantile(0.5);
  return summary;
}

/// Measures samples while another process publishes a waypoint per `interval`, or none if it is
/// unset.
void sample_written(benchmark::State& bench, std::optional<Time> interval) {
  const Pinned pin(kNear);
  const StreamName stream;
  const SharedLines lines;
  for (auto _ : bench) {
    apps::Child writer([&] { return write_stream(stream, 2 * kWrittenKnots, interval, lines[0]); });
    await(lines[0], 1);
    Walk walk(stream);
    const double mean = mean_time(walk);
    report(bench, time_alone(walk, interval.has_value()));
    bench.counters["mean_ns"] = mean;
    writer.stop();
    writer.result();
  }
}

BENCHMARK_CAPTURE(sample_written, quiet, std::nullopt)
    ->Name("sample/dims:7/writer:quiet")
    ->Iterations(1)
    ->UseManualTime();
BENCHMARK_CAPTURE(sample_written, slow, Time(10'000'000))
    ->Name("sample/dims:7/writer:100Hz")
    ->Iterations(1)
    ->UseManualTime();
BENCHMARK_CAPTURE(sample_written, fast, Time(1'000'000))
    ->Name("sample/dims:7/writer:1kHz")
    ->Iterations(1)
    ->UseManualTime();

}  // namespace
}  // namespace splinecast::bench
