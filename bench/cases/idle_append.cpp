#include <benchmark/benchmark.h>

#include <array>
#include <chrono>
#include <random>
#include <stdexcept>

#include "apps/process/signals.hpp"
#include "bench/harness/solved_streams.hpp"
#include "bench/harness/trips.hpp"
#include "ipc/memory/poll_schedule.hpp"
#include "ipc/sweep/many_streams.hpp"
#include "splinecast/producer.hpp"

namespace splinecast::bench {
namespace {

using std::chrono::milliseconds;

constexpr std::size_t kStreams = 1'000;
constexpr std::size_t kAppends = 200;
constexpr std::size_t kDimensions = 7;
constexpr Time kPatience = std::chrono::seconds(60);
/// Time of a waypoint minus the time at which it is appended.
constexpr Time kLead = milliseconds(200);

void append(Producer& producer, Time t, double x) {
  std::array<double, kDimensions> position{};
  position.fill(x);
  if (producer.append({.time = t, .position = position}) != AppendStatus::accepted) {
    throw std::runtime_error("a waypoint of an idle stream was refused");
  }
}

/// Waits until the curve moves at t.
void await_motion(Reader& reader, Time t, State& state) {
  const MonotonicClock clock;
  for (const Time end = clock.now() + kPatience; clock.now() < end;) {
    if (reader.preview(t, state) == SampleStatus::provisional) return;
    if (apps::stop_requested()) break;
  }
  throw std::runtime_error("the waypoint of an idle stream was not solved");
}

/// Measures the time from an append to an idle stream until a reader sees its knot. Each append is
/// to another stream, at a random phase of the solver's poll period.
nlohmann::json append_to_idle(std::vector<Producer>& producers, std::vector<Reader>& readers) {
  const MonotonicClock clock;
  std::mt19937_64 random(1);
  std::uniform_int_distribution<Time::rep> pause(0, ipc::PollSchedule::kIdlePause.count());
  State state(kDimensions);
  Trips trips(kAppends);
  for (std::size_t i = 0; i < kAppends; ++i) {
    apps::sleep_until(clock.now() + Time(pause(random)));
    const Time start = clock.now();
    append(producers[i], start + kLead, 1);
    await_motion(readers[i], start + kLead - milliseconds(1), state);
    trips.add(clock.now() - start);
  }
  return trips.summary();
}

void idle_append(benchmark::State& bench) {
  const MonotonicClock clock;
  for (auto _ : bench) {
    const SolvedStreams solved(kStreams, {.capacity = kBusyCapacity, .wake = false});
    std::vector<Producer> producers;
    producers.reserve(kStreams);
    for (const std::string& stream : solved.streams()) {
      producers.emplace_back(stream, ProducerOptions{.dimensions = kDimensions, .capacity = 256});
    }
    std::vector<Reader> readers = solved.attach_readers(kPatience);
    const Time first = clock.now() + kLead;
    for (Producer& producer : producers) append(producer, first, 0);
    for (Producer& producer : producers) {
      if (!producer.wait_until_consumed(kPatience)) {
        throw std::runtime_error("the first waypoint of an idle stream was not solved");
      }
    }
    apps::sleep_until(first + 2 * ipc::PollSchedule::kIdleAfter);
    report(bench, append_to_idle(producers, readers));
  }
  bench.counters["quiet_sweep_ns"] = static_cast<double>(ipc::PollSchedule::kIdlePause.count());
}

BENCHMARK(idle_append)
    ->Name("idle_append/streams:1000")
    ->Iterations(1)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace splinecast::bench
