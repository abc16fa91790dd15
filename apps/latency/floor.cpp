#include "apps/latency/floor.hpp"

#include <atomic>
#include <chrono>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>

#include "apps/process/child.hpp"
#include "apps/process/exit_codes.hpp"
#include "apps/process/shared_log.hpp"
#include "apps/process/signals.hpp"
#include "splinecast/clock.hpp"

namespace splinecast::apps {
namespace {

constexpr std::uint64_t kTrips = 100'000;
constexpr std::uint64_t kEnd = kTrips + 1;
constexpr Time kLongest = std::chrono::milliseconds(500);
constexpr Time kPatience = std::chrono::seconds(10);

/// One cache line per direction, each with the neighbour that is prefetched with it.
struct Lines {
  alignas(128) std::atomic<std::uint64_t> there{0};
  alignas(128) std::atomic<std::uint64_t> back{0};
};

/// Spins until the word is at least `value`. Returns false after kPatience, or if a stop is
/// requested.
bool await(const std::atomic<std::uint64_t>& word, std::uint64_t value) {
  const MonotonicClock clock;
  std::optional<Time> end;
  for (;;) {
    for (int spin = 0; spin < 100'000; ++spin) {
      if (word.load(std::memory_order_acquire) >= value) return true;
    }
    const Time now = clock.now();
    if (!end) end = now + kPatience;
    if (stop_requested() || now > *end) return false;
  }
}

void ping(Lines& lines, SharedLog<Time>& trips) {
  const MonotonicClock clock;
  trips.touch();
  if (!await(lines.back, 1)) throw TimeOut("the floor's peer process did not start");
  const Time end = clock.now() + kLongest;
  Time before = clock.now();
  for (std::uint64_t trip = 2; trip < kEnd && before < end; ++trip) {
    lines.there.store(trip, std::memory_order_release);
    if (!await(lines.back, trip)) throw TimeOut("the floor's peer process does not answer");
    const Time after = clock.now();
    if (!trips.push((after - before) / 2)) break;
    before = after;
  }
  lines.there.store(kEnd, std::memory_order_release);
}

void pong(Lines& lines) {
  std::uint64_t trip = 1;
  while (trip != kEnd) {
    lines.back.store(trip, std::memory_order_release);
    if (!await(lines.there, trip + 1)) throw TimeOut("the floor's peer process does not send");
    trip = lines.there.load(std::memory_order_relaxed);
  }
}

}  // namespace

LatencyFloor measure_floor(const LatencyOptions& options) {
  const auto first = options.cpu_producer;
  const auto second = options.cpu_reader(0);
  if (usable_cpus() < 2 || (first && first == second)) {
    return {.one_way = {}, .reason = "needs separate CPUs for the producer and the reader"};
  }
  const Shared<Lines> lines;
  SharedLog<Time> trips(kTrips);
  // The pipeline's processes report settings that do not take effect.
  Child other([&] {
    (void)adopt(options.settings(second), {});
    pong(*lines);
    return nlohmann::json();
  });
  Child asking([&] {
    (void)adopt(options.settings(first), {});
    ping(*lines, trips);
    return nlohmann::json();
  });
  asking.result();
  other.result();
  LatencyFloor floor;
  for (const Time one_way : trips.entries()) floor.one_way.record(one_way);
  return floor;
}

}  // namespace splinecast::apps
