#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <utility>
#include <vector>

#include "splinecast/ipc/sampler.hpp"
#include "support/memory_stream.hpp"

namespace splinecast::testing {

/// A live stream of one dimension in plain memory whose clock begins at 100 s. Its motion is
/// 1 − cos(t), in seconds from 50 ms behind that: it begins at rest.
struct LiveStream : MemoryStream {
  using Time = core::Time;
  static constexpr Time kNow = std::chrono::seconds(100);

  explicit LiveStream(core::WindowOptions how = {}, std::size_t capacity = 1024,
                      ipc::LiveOptions how_live = {}, std::size_t ring_capacity = 256)
      : MemoryStream(1, from_halt(std::move(how)), ring_capacity, capacity, {}, {}, how_live),
        sampler(board.reader, ipc::StreamClock::monotonic),
        state(1) {
    clock.time = kNow;
  }

  static core::WindowOptions from_halt(core::WindowOptions how) {
    how.start = {.kind = core::ConditionKind::halt, .value = {}};
    how.held_before_start = true;
    return how;
  }
  static double x(Time t) { return 1 - std::cos(seconds_of(t)); }
  static double velocity(Time t) { return std::sin(seconds_of(t)); }
  static double acceleration(Time t) { return std::cos(seconds_of(t)); }
  static double seconds_of(Time t) {
    return core::to_seconds(t - kNow - std::chrono::milliseconds(50));
  }

  ipc::AppendStatus put(Time t) {
    const double position = x(t);
    return ring.writer.append({.time = t, .position = std::span(&position, 1)}, solved());
  }
  ipc::WaypointRingWriter::Solved solved() {
    return {board.reader.tail(), solver.head().settled_until, &clock};
  }
  ipc::AppendStatus replace(Time t, const std::vector<Time>& times) {
    std::vector<double> positions;
    for (const Time at : times) positions.push_back(x(at));
    std::vector<core::Waypoint> waypoints;
    for (std::size_t i = 0; i < times.size(); ++i) {
      waypoints.push_back({.time = times[i], .position = std::span(&positions[i], 1)});
    }
    return ring.writer.replace_from(t, waypoints, solved());
  }
  /// Appends waypoints every 10 ms from `from` to `to` after the start.
  void put_all(int from_ms, int to_ms) {
    for (int ms = from_ms; ms <= to_ms; ms += 10) {
      ASSERT_EQ(put(kNow + std::chrono::milliseconds(ms)), ipc::AppendStatus::accepted) << ms;
    }
    drain();
  }
  /// Lets the solver work until it has nothing to take and no entry to look for.
  void drain() {
    constexpr int kMostSteps = 100;
    MemoryStream::drain();
    for (int i = 0; i < kMostSteps && solver.due() <= clock.time; ++i) solver.step(clock);
  }
  double position_at(Time t) {
    EXPECT_TRUE(ipc::has_values(sampler.preview(t, state.ref())));
    return state.position()[0];
  }
  ipc::Word reason(ipc::Refusal refusal) const {
    return solver.head().reasons[static_cast<std::size_t>(refusal)];
  }

  ipc::Sampler sampler;
  core::State state;
};

}  // namespace splinecast::testing
