#include <gtest/gtest.h>

#include <chrono>
#include <vector>

#include "ipc/ring/writer.hpp"
#include "splinecast/clock.hpp"
#include "tests/fixtures/streams/memory_stream.hpp"

/// The times of a live stream are compared with now, as those of another clock would stop it.
namespace splinecast::ipc {
namespace {

using namespace std::chrono_literals;
using testing::FixedClock;
using testing::MemoryRing;

constexpr Time kNow = 1000s;

/// A ring whose producer refuses times more than 10 s ahead of now.
struct WatchedRing : MemoryRing {
  explicit WatchedRing(Time settled = Time::min()) : MemoryRing(1, 64), settled_until(settled) {
    clock.time = kNow;
  }

  [[nodiscard]] WaypointRingWriter::Solved solved() const {
    return {.settled_until = settled_until, .clock = &clock, .horizon = 10s};
  }
  AppendStatus put(Time t) { return writer.append({.time = t, .position = x}, solved()); }
  AppendStatus replace(Time t, const std::vector<Time>& times) {
    std::vector<Waypoint> waypoints;
    for (const Time at : times) waypoints.push_back({.time = at, .position = x});
    return writer.replace_from(t, waypoints, solved());
  }
  AppendStatus start(Time t) {
    return writer.start_from({.time = t, .position = x, .velocity = x, .acceleration = x},
                             solved());
  }

  Time settled_until;
  FixedClock clock;
  std::vector<double> x{0};
};

TEST(Horizon, IsCountedFromTheLaterOfNowAndTheSettledTime) {
  for (const Time settled : {Time::min(), kNow - 100s, kNow + 5ms}) {
    WatchedRing ring(settled);
    const Time latest = std::max(settled, kNow) + 10s;
    EXPECT_EQ(ring.put(latest + Time(1)), AppendStatus::too_far_ahead);
    EXPECT_EQ(ring.put(kLatestTime), AppendStatus::too_far_ahead);
    EXPECT_EQ(ring.put(latest), AppendStatus::accepted);
    EXPECT_EQ(ring.put(latest + 1s), AppendStatus::too_far_ahead);
    ring.clock.time += 1s;
    ring.settled_until += settled > kNow ? 1s : 0s;
    EXPECT_EQ(ring.put(latest + 1s), AppendStatus::accepted);
    EXPECT_EQ(ring.reader.refused(AppendStatus::too_far_ahead), 3U);
  }
}

TEST(Horizon, HoldsForReplacementsStopsAndStartStates) {
  WatchedRing ring;
  EXPECT_EQ(ring.replace(kNow + 1s, {kNow + 2s, kNow + 10s + Time(1)}),
            AppendStatus::too_far_ahead);
  EXPECT_EQ(ring.replace(kNow + 11s, {}), AppendStatus::too_far_ahead);
  EXPECT_EQ(ring.start(kNow + 11s), AppendStatus::too_far_ahead);
  EXPECT_EQ(ring.writer.written(), 0U);
  EXPECT_EQ(ring.start(kNow + 10s), AppendStatus::accepted);
  EXPECT_EQ(ring.replace(kNow + 9s, {}), AppendStatus::accepted);
}

TEST(Horizon, TheFirstWaypointIsNotInThePast) {
  WatchedRing ring;
  EXPECT_EQ(ring.put(Time::zero()), AppendStatus::past);
  EXPECT_EQ(ring.put(kNow - Time(1)), AppendStatus::past);
  EXPECT_EQ(ring.start(kNow - 250ms - Time(1)), AppendStatus::past);
  EXPECT_EQ(ring.replace(kNow - 2s, {kNow - 1s}), AppendStatus::too_late);
  EXPECT_EQ(ring.put(kNow), AppendStatus::accepted);
  ring.clock.time += 1s;
  EXPECT_EQ(ring.put(kNow + 900ms), AppendStatus::accepted);  // late, which the solver deals with
}

TEST(Horizon, AStartStateMayComeLate) {
  WatchedRing ring;
  EXPECT_EQ(ring.start(kNow - 250ms), AppendStatus::accepted);
  EXPECT_EQ(ring.put(kNow - 240ms), AppendStatus::accepted);
}

TEST(Horizon, ATimeOfAnotherClockIsNamed) {
  const Time now = MonotonicClock().now();
  const Time wall = std::chrono::system_clock::now().time_since_epoch();
  const auto text = [](Time time) { return compared_with_now(time); };
  const auto names = [&](Time time, const char* clock) {
    EXPECT_NE(text(time).find(clock), std::string::npos) << text(time);
  };
  names(wall, "it looks like CLOCK_REALTIME");
  names(Time(wall / 1us), "CLOCK_REALTIME in µs");
  names(Time(wall / 1ms), "CLOCK_REALTIME in ms");
  names(Time(wall / 1s), "CLOCK_REALTIME in s");
  if (now > 2min) {
    names(Time::zero(), "counts from 0");
    names(Time(now / 1s), "CLOCK_MONOTONIC in s as an integer");
  }
  EXPECT_EQ(text(now).find("looks like"), std::string::npos) << text(now);
  EXPECT_NE(text(now + 2h).find(" s after now, "), std::string::npos);
  EXPECT_NE(text(-kLatestTime).find(" s before now, "), std::string::npos);
}

}  // namespace
}  // namespace splinecast::ipc
