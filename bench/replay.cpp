#include <benchmark/benchmark.h>
#include <fmt/format.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "bench_stream.hpp"
#include "replay.hpp"
#include "support/waypoint_table.hpp"

namespace splinecast::bench {
namespace {

/// A recording as text: nanoseconds, and values with the digits of a float, as recorders write
/// them.
class Recording {
 public:
  explicit Recording(std::size_t dimensions)
      : path_(std::filesystem::temp_directory_path() /
              fmt::format("splinecast_bench.{}.csv", getpid())) {
    std::ofstream file(path_);
    file << "t_ns";
    for (std::size_t d = 0; d < dimensions; ++d) file << ",q" << d;
    Feed feed(dimensions);
    for (std::size_t i = 0; i < kRows; ++i) {
      const core::Waypoint waypoint = feed.next();
      file << '\n' << waypoint.time.count();
      for (const double x : waypoint.position) file << fmt::format(",{}", static_cast<float>(x));
    }
    file << '\n';
  }
  Recording(const Recording&) = delete;
  Recording& operator=(const Recording&) = delete;
  ~Recording() { std::filesystem::remove(path_); }

  static constexpr std::size_t kRows = 200'000;
  [[nodiscard]] std::string path() const { return path_.string(); }
  [[nodiscard]] std::size_t bytes() const { return std::filesystem::file_size(path_); }

 private:
  std::filesystem::path path_;
};

const Recording& recording() {
  static const Recording seven(7);
  return seven;
}

void count(benchmark::State& bench, std::size_t per_iteration_bytes) {
  const auto runs = static_cast<std::int64_t>(bench.iterations());
  bench.SetItemsProcessed(runs * static_cast<std::int64_t>(Recording::kRows));
  bench.SetBytesProcessed(runs * static_cast<std::int64_t>(per_iteration_bytes));
}

/// CSV text to a table.
void parse(benchmark::State& bench) {
  const std::string path = recording().path();
  for (auto _ : bench) benchmark::DoNotOptimize(apps::read_waypoints(path, {}).positions.data());
  count(bench, recording().bytes());
}

/// CSV text to settled segments in shared memory, as `replay --embedded --rate max` does it.
void replay(benchmark::State& bench) {
  const StreamName stream;
  apps::ReplayOptions options{.file = recording().path(),
                              .stream = stream,
                              .rate = {},
                              .clock = ipc::StreamClock::recorded,
                              .embedded = true,
                              .quiet = true};
  for (auto _ : bench) {
    apps::WaypointTable table = apps::read_waypoints(options.file, options.table);
    apps::RefusedRows refused;
    apps::prepare_replay(table, options, refused);
    const apps::ReplayReport report = apps::replay_table(table, options, refused);
    if (report.interpolated != Recording::kRows) bench.SkipWithError("waypoints were lost");
  }
  count(bench, recording().bytes());
}

BENCHMARK(parse)->Name("parse/dims:7")->Unit(benchmark::kMillisecond);
BENCHMARK(replay)->Name("replay/dims:7")->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace splinecast::bench
