#include "bench/harness/bench_stream.hpp"

#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <exception>

#include "splinecast/producer.hpp"
#include "splinecast/solver.hpp"
#include "splinecast/streams.hpp"

namespace splinecast::bench {

void all_dimensions(benchmark::internal::Benchmark* bench) {
  for (const int dimensions : {1, 3, 6, 7, 16, 32}) bench->Arg(dimensions);
}

Waypoints::Waypoints(std::size_t count, std::size_t dims) : dimensions(dims) {
  Time t{};
  for (std::size_t i = 0; i < count; ++i) {
    times.push_back(t);
    for (std::size_t d = 0; d < dims; ++d) {
      positions.push_back(std::sin(2e-9 * static_cast<double>(t.count()) + static_cast<double>(d)));
    }
    t += Time(9'000'000 + static_cast<std::int64_t>(i * 7919 % 2'000'000));
  }
}

Feed::Feed(std::size_t dimensions) : waypoints_(4096, dimensions) {}

Waypoint Feed::next() {
  if (i_ == waypoints_.times.size()) {
    i_ = 0;
    offset_ += waypoints_.times.back() + Time(10'000'000);
  }
  const Waypoint waypoint{.time = offset_ + waypoints_.times[i_],
                          .position = waypoints_.position(i_)};
  ++i_;
  return waypoint;
}

StreamName::StreamName() {
  static int number = 0;
  name_ = "bench." + std::to_string(getpid()) + '.' + std::to_string(number++);
}

StreamName::~StreamName() {
  try {
    remove_stream(name_);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "splinecast_bench: stream %s was not removed: %s\n", name_.c_str(),
                 error.what());
  }
}

BenchStream::BenchStream(const Waypoints& waypoints) {
  Producer producer(
      name_, {.dimensions = waypoints.dimensions, .clock = StreamClock::recorded, .start = {}});
  Solver solver(name_, {.capacity = waypoints.times.size()});
  solver.attach();
  const MonotonicClock clock;
  for (std::size_t i = 0; i < waypoints.times.size(); ++i) {
    const Waypoint waypoint{.time = waypoints.times[i], .position = waypoints.position(i)};
    while (producer.append(waypoint) == AppendStatus::full) solver.step(clock);
  }
  while (producer.finish({}) == AppendStatus::full) solver.step(clock);
  while (solver.step(clock).consumed > 0) {
  }
}

}  // namespace splinecast::bench
