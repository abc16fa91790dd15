#pragma once

#include <chrono>
#include <cstddef>
#include <optional>
#include <vector>

#include "apps/latency/stamps.hpp"
#include "apps/process/settings.hpp"
#include "apps/timing/open_loop.hpp"
#include "splinecast/time.hpp"

namespace splinecast::apps {

/// Options of `latency`.
struct LatencyOptions {
  double rate = 1000;  ///< waypoints per second
  Time duration = std::chrono::seconds(10);
  Time warmup = std::chrono::seconds(1);
  Time lead = std::chrono::milliseconds(200);  ///< a waypoint's time minus the instant it is due
  std::optional<Time> deadline{};              ///< default: one period
  std::size_t dimensions = 7;
  std::optional<std::size_t> settle{};
  std::size_t readers = 1;
  bool embedded = false;  ///< the solver runs in the producer's process
  bool spin = false;      ///< poll instead of sleeping until there is work to do
  std::optional<int> cpu_producer{};
  std::optional<int> cpu_solver{};
  std::vector<int> cpu_readers{};  ///< reader r uses the entry r modulo their number
  bool fifo = false;
  int priority = 50;
  bool lock_memory = false;
  bool iceoryx = true;

  [[nodiscard]] Time period() const { return Time(static_cast<std::int64_t>(1e9 / rate)); }
  [[nodiscard]] Schedule schedule(Time start) const {
    return {.start = start,
            .period = period(),
            .count = static_cast<std::size_t>((warmup + duration) / period())};
  }
  [[nodiscard]] Measured measured(Time start) const {
    return {.from = start + warmup,
            .until = start + warmup + duration,
            .deadline = deadline.value_or(period())};
  }
  [[nodiscard]] std::size_t processes() const { return 1 + (embedded ? 0 : 1) + readers; }
  [[nodiscard]] ProcessSettings settings(std::optional<int> cpu) const {
    return {.cpu = cpu, .fifo = fifo, .priority = priority, .lock_memory = lock_memory};
  }
  [[nodiscard]] std::optional<int> cpu_reader(std::size_t r) const {
    if (cpu_readers.empty()) return std::nullopt;
    return cpu_readers[r % cpu_readers.size()];
  }
};

}  // namespace splinecast::apps
