#include "bench/harness/writer.hpp"

#include <stdexcept>

#include "apps/process/signals.hpp"
#include "bench/harness/bench_stream.hpp"
#include "bench/harness/trips.hpp"
#include "splinecast/producer.hpp"
#include "splinecast/solver.hpp"

namespace splinecast::bench {
namespace {

/// Longest sleep of a writer that has nothing to publish.
constexpr Time kLongestSleep{3'600'000'000'000};

}  // namespace

nlohmann::json write_stream(const std::string& stream, std::size_t capacity,
                            std::optional<Time> interval, std::atomic<std::uint64_t>& ready) {
  const Pinned pin(kFar);
  Feed feed(kWrittenDimensions);
  Producer producer(
      stream, {.dimensions = kWrittenDimensions, .clock = StreamClock::recorded, .start = {}});
  Solver solver(stream, {.capacity = capacity, .wake = false});
  solver.attach();
  const MonotonicClock clock;
  const auto publish = [&] {
    if (producer.append(feed.next()) != AppendStatus::accepted) {
      throw std::runtime_error("a waypoint was refused");
    }
    solver.step(clock);
  };
  for (std::size_t i = 0; i < kWrittenKnots; ++i) publish();
  ready.store(1, std::memory_order_release);
  Time next = clock.now();
  while (!apps::stop_requested()) {
    if (!interval) {
      apps::sleep_until(clock.now() + kLongestSleep);
    } else if (*interval == Time::zero() || apps::sleep_until(next += *interval)) {
      publish();
    }
  }
  return nullptr;
}

}  // namespace splinecast::bench
