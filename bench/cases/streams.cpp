#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <chrono>
#include <string>
#include <vector>

#include "apps/process/signals.hpp"
#include "apps/process/use.hpp"
#include "apps/soak/roles.hpp"
#include "bench/harness/solved_streams.hpp"
#include "ipc/memory/poll_schedule.hpp"
#include "ipc/roles/internals.hpp"
#include "ipc/sweep/many_streams.hpp"

/// The CPU time that one process needs to solve many streams of seven dimensions. The time of these
/// rows is the CPU time of that process per second: 10 ms are 1 % of a core.
namespace splinecast::bench {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr double kRate = 100;
constexpr Time kPatience = seconds(60);
constexpr Time kWindow = seconds(1);

/// Streams that one process solves, and their producers in another one.
class ManyStreams {
 public:
  /// The motion begins in one second; idle streams do not move.
  ManyStreams(std::size_t count, bool are_idle, const SolverOptions& options)
      : solved_(count, options), producers_([&] {
          const Time begin = clock_.now() + (are_idle ? seconds(1'000'000) : seconds(1));
          return apps::run_soak_producers(solved_.streams(), kRate, begin);
        }) {
    readers_ = solved_.attach_readers(kPatience);
    const Time end = clock_.now() + kPatience;  // no error: the rows report waypoints_per_s
    while (!are_idle && !all_move() && clock_.now() < end) {
      apps::sleep_until(clock_.now() + milliseconds(10));
    }
  }
  ManyStreams(const ManyStreams&) = delete;
  ManyStreams& operator=(const ManyStreams&) = delete;
  ~ManyStreams() {
    producers_.stop();
    (void)producers_.result();
  }

  [[nodiscard]] pid_t solver() const { return solved_.solver(); }
  [[nodiscard]] std::vector<Reader>& readers() { return readers_; }

  /// Waypoints that the solver has consumed so far, and its deadline_misses and late_commits.
  struct Solved {
    double waypoints = 0;
    double missed = 0;
  };
  [[nodiscard]] Solved solved() const {
    Solved sum;
    ipc::Summary summary;
    for (const Reader& reader : readers_) {
      if (!ipc::Internals::summary(reader, summary)) continue;
      sum.waypoints += static_cast<double>(summary.knots);
      sum.missed += static_cast<double>(summary.deadline_misses + summary.late_commits);
    }
    return sum;
  }

 private:
  /// Whether every stream has two knots, so that it can move.
  [[nodiscard]] bool all_move() const {
    ipc::Summary summary;
    for (const Reader& reader : readers_) {
      if (!ipc::Internals::summary(reader, summary) || summary.knots < 2) return false;
    }
    return true;
  }

  MonotonicClock clock_;
  SolvedStreams solved_;
  apps::Child producers_;
  std::vector<Reader> readers_;
};

/// The streams of a row.
struct Row {
  std::size_t streams;
  bool is_idle;
  bool wakes = false;  ///< the solver wakes readers, by one system call per revision
  Time freeze_ahead = milliseconds(5);
};

SolverOptions options_of(const Row& row) {
  return {.freeze_ahead = row.freeze_ahead, .capacity = kBusyCapacity, .wake = row.wakes};
}

/// Measures the solver's CPU time over 1 s per iteration; with idle streams, only after the solver
/// treats them as idle.
void solve(benchmark::State& bench, Row row) {
  ManyStreams world(row.streams, row.is_idle, options_of(row));
  const MonotonicClock clock;
  if (row.is_idle) apps::sleep_until(clock.now() + 2 * ipc::PollSchedule::kIdleAfter);
  const auto before = world.solved();
  double cpu = 0;
  double wall = 0;
  for (auto _ : bench) {
    const Time begin = clock.now();
    const Time taken = apps::cpu_time(world.solver());
    apps::sleep_until(begin + kWindow);
    const double taken_now = to_seconds(apps::cpu_time(world.solver()) - taken);
    const double passed = to_seconds(clock.now() - begin);
    bench.SetIterationTime(taken_now / passed);
    cpu += taken_now;
    wall += passed;
  }
  const auto after = world.solved();
  const auto streams = static_cast<double>(row.streams);
  bench.counters["core_percent"] = 100 * cpu / wall;
  bench.counters["us_per_stream_and_s"] = 1e6 * cpu / wall / streams;
  bench.counters["waypoints_per_s"] = (after.waypoints - before.waypoints) / wall;
  bench.counters["late"] = after.missed - before.missed;
  if (const auto use = apps::process_use(world.solver())) {
    bench.counters["kB_per_stream"] = static_cast<double>(use->resident_bytes) / streams / 1e3;
    bench.counters["files_per_stream"] = static_cast<double>(use->descriptors) / streams;
  }
}

/// Samples all streams in turn, one sample per iteration.
void sample(benchmark::State& bench, Row row) {
  ManyStreams world(row.streams, row.is_idle, options_of(row));
  const MonotonicClock clock;
  State state(world.readers().front().dimensions());
  std::size_t i = 0;
  for (auto _ : bench) {
    benchmark::DoNotOptimize(world.readers()[i].sample(clock.now(), state));
    benchmark::DoNotOptimize(state.values().data());
    i = (i + 1) % row.streams;
  }
}

void add(const std::string& name, const Row& row) {
  benchmark::RegisterBenchmark(fmt::format("streams:{}/{}", row.streams, name).c_str(), solve, row)
      ->UseManualTime()
      ->Iterations(3)
      ->Unit(benchmark::kMillisecond);
}

const bool is_registered = [] {
  for (const std::size_t streams : {10U, 100U, 1000U}) {
    add("idle", {.streams = streams, .is_idle = true});
    add("busy:100Hz", {.streams = streams, .is_idle = false});
    benchmark::RegisterBenchmark(fmt::format("streams:{}/sample", streams).c_str(), sample,
                                 Row{.streams = streams, .is_idle = false});
  }
  add("busy:100Hz/freeze:50ms",
      {.streams = 1000, .is_idle = false, .freeze_ahead = milliseconds(50)});
  add("busy:100Hz/wake", {.streams = 1000, .is_idle = false, .wakes = true});
  return true;
}();

}  // namespace
}  // namespace splinecast::bench
