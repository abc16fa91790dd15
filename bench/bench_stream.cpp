#include "bench_stream.hpp"

#include <unistd.h>

#include <cmath>

#include "splinecast/ipc/producer.hpp"
#include "splinecast/ipc/solver.hpp"
#include "splinecast/ipc/stream_files.hpp"

namespace splinecast::bench {

Waypoints::Waypoints(std::size_t count, std::size_t dims) : dimensions(dims) {
  core::Time t{};
  for (std::size_t i = 0; i < count; ++i) {
    times.push_back(t);
    for (std::size_t d = 0; d < dims; ++d) {
      positions.push_back(std::sin(2e-9 * static_cast<double>(t.count()) + static_cast<double>(d)));
    }
    t += core::Time(9'000'000 + static_cast<std::int64_t>(i * 7919 % 2'000'000));
  }
}

BenchStream::BenchStream(const Waypoints& waypoints) : name_("bench." + std::to_string(getpid())) {
  ipc::Producer producer(
      name_,
      {.dimensions = waypoints.dimensions, .clock = ipc::StreamClock::recorded, .start = {}});
  ipc::Solver solver(name_, {.capacity = waypoints.times.size()});
  solver.attach();
  const ipc::MonotonicClock clock;
  const std::span<const double> positions(waypoints.positions);
  for (std::size_t i = 0; i < waypoints.times.size(); ++i) {
    const core::Waypoint waypoint{
        .time = waypoints.times[i],
        .position = positions.subspan(i * waypoints.dimensions, waypoints.dimensions)};
    while (producer.append(waypoint) == ipc::AppendStatus::full) solver.step(clock);
  }
  while (producer.finish({}) == ipc::AppendStatus::full) solver.step(clock);
  while (solver.step(clock).consumed > 0) {
  }
}

BenchStream::~BenchStream() { ipc::remove_stream(name_); }

}  // namespace splinecast::bench
