#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "ipc/sweep/many_streams.hpp"
#include "splinecast/producer.hpp"
#include "tests/fixtures/processes/process.hpp"

namespace splinecast::testing {

using News = std::vector<std::pair<ipc::SweepNews, std::string>>;

/// A sweep whose news are recorded.
struct RecordingSweep {
  News news;
  std::string why;
  ipc::StreamSweep sweep;
  MonotonicClock clock;

  explicit RecordingSweep(const std::vector<std::string>& wanted,
                          const SolverOptions& options = small())
      : sweep(wanted, options,
              [this](ipc::SweepNews what, const std::string& stream, const Solver* /*solver*/,
                     std::string_view reason) {
                news.emplace_back(what, stream);
                if (!reason.empty()) why = reason;
              }) {}

  static SolverOptions small() { return {.capacity = 64}; }

  [[nodiscard]] std::ptrdiff_t count(ipc::SweepNews what, const std::string& stream) const {
    return std::ranges::count(news, std::pair(what, stream));
  }
  /// Sweeps until this news is reported.
  bool await_news(ipc::SweepNews what, const std::string& stream) {
    return await([&] {
      sweep.sweep(clock);
      return count(what, stream) > 0;
    });
  }
};

/// A producer of one dimension.
inline Producer make_producer(const std::string& stream,
                              StreamClock clock = StreamClock::recorded) {
  return {stream, {.dimensions = 1, .clock = clock, .capacity = 64}};
}

/// Appends a waypoint.
inline void append_at(Producer& producer, Time t) {
  const std::vector<double> x{1};
  ASSERT_EQ(producer.append({.time = t, .position = x}), AppendStatus::accepted);
}

}  // namespace splinecast::testing
