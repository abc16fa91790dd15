#include <benchmark/benchmark.h>

#include <array>
#include <optional>
#include <stdexcept>

#include "bench/harness/bench_stream.hpp"
#include "bench/harness/roundtrip.hpp"
#include "splinecast/producer.hpp"
#include "splinecast/reader.hpp"
#include "splinecast/solver.hpp"

namespace splinecast::bench {
namespace {

constexpr std::uint64_t kWarmUp = 1'000;
constexpr std::uint64_t kTrips = 20'000;

}  // namespace

nlohmann::json measure(const std::function<bool(std::uint64_t)>& trip) {
  const MonotonicClock clock;
  Trips trips(kTrips);
  for (std::uint64_t i = 2; i < 2 + kWarmUp + kTrips; ++i) {
    const Time start = clock.now();
    if (!trip(i)) throw std::runtime_error("the round trips were interrupted");
    if (i >= 2 + kWarmUp) trips.add(clock.now() - start);
  }
  return trips.summary();
}

namespace {

constexpr Time kPatience{10'000'000'000};

/// A time half an interval before waypoint i. The curve is the stop segment there until waypoint i
/// is appended.
Time requested_time(std::uint64_t i) { return time_of(i) - kTripInterval / 2; }

/// Appends the waypoints of the round trips to a stream of this process.
class Appender {
 public:
  explicit Appender(const std::string& stream)
      : producer_(stream,
                  {.dimensions = kTripDimensions, .clock = StreamClock::recorded, .start = {}}) {}
  void append(std::uint64_t i) {
    position_.fill(static_cast<double>(i % 16));
    if (producer_.append({.time = time_of(i), .position = position_}) != AppendStatus::accepted) {
      throw std::runtime_error("a waypoint of the round trips was refused");
    }
  }
  Producer& producer() { return producer_; }

 private:
  Producer producer_;
  std::array<double, kTripDimensions> position_{};
};

/// Samples until the curve reaches waypoint i; false if a stop is requested.
bool await_waypoint(Reader& reader, State& state, std::uint64_t i) {
  for (;;) {
    const SampleStatus status = reader.sample(requested_time(i), state);
    if (status == SampleStatus::provisional || status == SampleStatus::settled) {
      benchmark::DoNotOptimize(state.values().data());
      return true;
    }
    if (apps::stop_requested()) return false;
  }
}

/// The lower bound of a round trip: one word each way, each on its own cache line.
void floor_ping(benchmark::State& bench) {
  const SharedLines lines;
  for (auto _ : bench) {
    apps::Child far([&]() -> nlohmann::json {
      const Pinned pin(kFar);
      for (std::uint64_t i = 2; await(lines[kThere], i); ++i) {
        lines[kBack].store(i, std::memory_order_release);
      }
      return nullptr;
    });
    apps::Child near([&] {
      const Pinned pin(kNear);
      return measure([&](std::uint64_t i) {
        lines[kThere].store(i, std::memory_order_release);
        return await(lines[kBack], i);
      });
    });
    report(bench, near.result());
    far.stop();
    far.result();
  }
}

/// The near core appends and publishes; a reader on the far core samples and acknowledges.
void roundtrip_embedded(benchmark::State& bench, std::optional<std::size_t> settle) {
  const SharedLines lines;
  const StreamName stream;
  for (auto _ : bench) {
    apps::Child near([&] {
      const Pinned pin(kNear);
      Appender appender(stream);
      Solver solver(stream, {.settle = settle, .wake = false});
      solver.attach();
      const MonotonicClock clock;
      const auto publish = [&](std::uint64_t i) {
        appender.append(i);
        solver.step(clock);
      };
      publish(1);
      await(lines[kFarIsReady], 1);
      return measure([&](std::uint64_t i) {
        publish(i);
        return await(lines[kBack], i);
      });
    });
    apps::Child far([&]() -> nlohmann::json {
      const Pinned pin(kFar);
      Reader reader(stream, kPatience);
      State state(kTripDimensions);
      lines[kFarIsReady].store(1, std::memory_order_release);
      for (std::uint64_t i = 2; await_waypoint(reader, state, i); ++i) {
        lines[kBack].store(i, std::memory_order_release);
      }
      return nullptr;
    });
    report(bench, near.result());
    far.stop();
    far.result();
  }
}

/// The near core appends, a solver on the far core publishes, the near core samples.
void roundtrip_solver(benchmark::State& bench) {
  const StreamName stream;
  for (auto _ : bench) {
    apps::Child near([&] {
      const Pinned pin(kNear);
      Appender appender(stream);
      appender.append(1);
      Reader reader(stream, kPatience);
      State state(kTripDimensions);
      if (!appender.producer().wait_until_consumed(kPatience)) {
        throw std::runtime_error("the solver of the round trips did not attach");
      }
      return measure([&](std::uint64_t i) {
        appender.append(i);
        return await_waypoint(reader, state, i);
      });
    });
    apps::Child far([&]() -> nlohmann::json {
      const Pinned pin(kFar);
      Solver solver(stream, {.wake = false});
      while (!solver.attach() && !apps::stop_requested()) solver.wait(Time(1'000'000));
      const MonotonicClock clock;
      while (!apps::stop_requested()) solver.step(clock);
      return nullptr;
    });
    report(bench, near.result());
    far.stop();
    far.result();
  }
}

BENCHMARK(floor_ping)->Name("floor/ping")->Iterations(1)->UseManualTime();
BENCHMARK_CAPTURE(roundtrip_embedded, , std::nullopt)
    ->Name("roundtrip/embedded")
    ->Iterations(1)
    ->UseManualTime();
/// With settle lag 0 a waypoint changes the fewest segments: most of the time is transport.
BENCHMARK_CAPTURE(roundtrip_embedded, , 0)
    ->Name("roundtrip/embedded/settle:0")
    ->Iterations(1)
    ->UseManualTime();
BENCHMARK(roundtrip_solver)->Name("roundtrip/solver")->Iterations(1)->UseManualTime();

}  // namespace
}  // namespace splinecast::bench
