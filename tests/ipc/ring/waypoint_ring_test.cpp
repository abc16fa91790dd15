#include "ipc/ring/writer.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "ipc/layout/ring_control.hpp"
#include "ipc/ring/item.hpp"
#include "tests/fixtures/streams/memory_stream.hpp"

namespace splinecast::ipc {
namespace {

using testing::MemoryRing;

constexpr Time kMillisecond{1'000'000};

AppendStatus append(MemoryRing& ring, Time t, std::vector<double> x, Word consumed = 0) {
  return ring.writer.append({.time = t, .position = x, .velocity = {}, .acceleration = {}},
                            {consumed});
}

TEST(WaypointRing, ReturnsTheAppendedItems) {
  MemoryRing ring(2, 4);
  const std::vector<double> x{1, 2};
  const std::vector<double> v{3, 4};
  const std::vector<double> a{5, 6};
  ASSERT_EQ(ring.writer.append({kMillisecond, x, v, a}, {}), AppendStatus::accepted);
  ASSERT_EQ(append(ring, 2 * kMillisecond, {7, 8}), AppendStatus::accepted);
  RingItem item(2);
  ring.reader.copy(0, item);
  EXPECT_EQ(item.kind, ItemKind::waypoint);
  EXPECT_EQ(item.time, kMillisecond);
  EXPECT_TRUE(item.has_velocity && item.has_acceleration);
  EXPECT_EQ(item.values, (std::vector<double>{1, 2, 3, 4, 5, 6}));
  ring.reader.copy(1, item);
  EXPECT_FALSE(item.has_velocity || item.has_acceleration);
  EXPECT_EQ(item.values[0], 7);
  EXPECT_EQ(ring.reader.written(), 2U);
}

TEST(WaypointRing, RefusesInvalidWaypointsWithAReasonAndCountsThem) {
  MemoryRing ring(2, 8);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  EXPECT_EQ(append(ring, kMillisecond, {1}), AppendStatus::wrong_dimension);
  EXPECT_EQ(append(ring, kMillisecond, {1, nan}), AppendStatus::not_finite);
  const std::vector<double> x{1, 2};
  const std::vector<double> bad{inf, 0};
  EXPECT_EQ(ring.writer.append({kMillisecond, x, bad, {}}, {}), AppendStatus::not_finite);
  EXPECT_EQ(ring.writer.append({kMillisecond, x, {}, std::span(x).first(1)}, {}),
            AppendStatus::wrong_dimension);
  EXPECT_EQ(append(ring, kMillisecond, {1, 2}), AppendStatus::accepted);
  EXPECT_EQ(append(ring, kMillisecond, {1, 2}), AppendStatus::duplicate);
  EXPECT_EQ(append(ring, Time(0), {1, 2}), AppendStatus::out_of_order);
  EXPECT_EQ(append(ring, kMillisecond + Time(999), {1, 2}), AppendStatus::too_close);
  EXPECT_EQ(append(ring, kMillisecond + Time(3'600'000'000'001), {1, 2}),
            AppendStatus::too_far_apart);
  EXPECT_EQ(append(ring, kMillisecond + Time(1000), {1, 2}), AppendStatus::accepted);
  EXPECT_EQ(ring.writer.written(), 2U);
  EXPECT_EQ(ring.reader.refused(AppendStatus::not_finite), 2U);
  EXPECT_EQ(ring.reader.refused(AppendStatus::wrong_dimension), 2U);
  EXPECT_EQ(ring.reader.refused(AppendStatus::duplicate), 1U);
  EXPECT_EQ(ring.reader.refused(AppendStatus::out_of_order), 1U);
  EXPECT_EQ(ring.reader.refused(AppendStatus::too_close), 1U);
  EXPECT_EQ(ring.reader.refused(AppendStatus::too_far_apart), 1U);
}

TEST(WaypointRing, AcceptsTheEarliestAndTheLatestTimeInOrder) {
  MemoryRing ring(1, 8);
  EXPECT_EQ(append(ring, -kLatestTime - Time(1), {0}), AppendStatus::too_far_apart);
  EXPECT_EQ(append(ring, -kLatestTime, {0}), AppendStatus::accepted);
  EXPECT_EQ(append(ring, kLatestTime + Time(1), {0}), AppendStatus::too_far_apart);
  EXPECT_EQ(append(ring, kLatestTime, {0}), AppendStatus::too_far_apart);
  const IntervalRange any{.least = Time(1), .most = Time::max()};
  testing::MemoryStream stream(1, {}, 8, 64, any);
  stream.ring.writer = WaypointRingWriter(stream.ring.bytes.span(), stream.ring.layout, any);
  const std::vector<double> x{0, 1};
  EXPECT_EQ(stream.append(-kLatestTime, std::span(x).first(1)), AppendStatus::accepted);
  EXPECT_EQ(stream.append(kLatestTime, std::span(x).last(1)), AppendStatus::accepted);
  stream.drain();
  EXPECT_EQ(stream.solver.summary().knots, 2U);
  KnotCopy knot(1, false);
  ASSERT_TRUE(stream.board.reader.copy_knot(1, stream.board.reader.revision(), knot));
  EXPECT_NEAR(knot.velocity()[0] * 2 * to_seconds(kLatestTime), 1, 1e-12);
}

TEST(WaypointRing, IsFullUntilTheSolverConsumesAndLosesNothing) {
  MemoryRing ring(1, 4);
  RingItem item(1);
  Word consumed = 0;
  double next_in = 0;
  double next_out = 0;
  for (int round = 0; round < 20; ++round) {
    while (append(ring, Time(static_cast<std::int64_t>(next_in + 1) * 10'000), {next_in},
                  {consumed}) == AppendStatus::accepted) {
      ++next_in;
    }
    EXPECT_EQ(ring.writer.written() - consumed, 4U);
    for (int i = 0; i <= round % 4; ++i) {
      ring.reader.copy(consumed++, item);
      EXPECT_EQ(item.values[0], next_out++);
    }
  }
}

TEST(WaypointRing, APassiveObserverKeepsAnItemOnlyWhileItCannotBeOverwritten) {
  MemoryRing ring(1, 4);
  RingItem item(1);
  for (int i = 0; i < 4; ++i) {
    ASSERT_EQ(append(ring, Time(10'000 * (i + 1)), {1.0 * i}), AppendStatus::accepted);
  }
  EXPECT_FALSE(ring.reader.observe(0, item));  // the producer may be overwriting it with item 4
  EXPECT_TRUE(ring.reader.observe(1, item));
  EXPECT_EQ(item.values[0], 1);
}

TEST(WaypointRing, APassiveObserverKeepsNoItemThatAnUnfinishedReplacementOverwrites) {
  MemoryRing ring(1, 8);
  RingItem item(1);
  for (int i = 0; i < 8; ++i) {
    ASSERT_EQ(append(ring, Time(10'000 * (i + 1)), {1.0 * i}), AppendStatus::accepted);
  }
  const std::vector<double> x{-1};
  const std::vector<Waypoint> replacing{{.time = Time(200'000), .position = x},
                                        {.time = Time(300'000), .position = x}};
  ASSERT_EQ(ring.writer.replace_from(Time(100'000), replacing, {8}), AppendStatus::accepted);
  // Undoes the last store of the replacement, which appended all of its items.
  const auto control = words_at(ring.bytes.span(), ring.layout.control, kClaimed + 1);
  store(control[kWritten], 8, std::memory_order_relaxed);
  for (Word i = 0; i < 3; ++i) EXPECT_FALSE(ring.reader.observe(i, item)) << i;
  for (Word i = 3; i < 8; ++i) EXPECT_TRUE(ring.reader.observe(i, item)) << i;
  // The producer has died. The next one claims fewer items; the overwritten ones stay lost.
  WaypointRingWriter next(ring.bytes.span(), ring.layout, {});
  ASSERT_EQ(next.replace_from(Time(100'000), {}, {8}), AppendStatus::accepted);
  EXPECT_FALSE(ring.reader.observe(2, item));
  EXPECT_TRUE(ring.reader.observe(3, item));
}

TEST(WaypointRing, RefusesItemsAfterAFinishAndKeepsItsCondition) {
  MemoryRing ring(2, 4);
  ASSERT_EQ(append(ring, kMillisecond, {1, 2}), AppendStatus::accepted);
  ASSERT_EQ(ring.writer.finish({ConditionKind::velocity, {3, 4}}, {}), AppendStatus::accepted);
  EXPECT_EQ(append(ring, 2 * kMillisecond, {1, 2}), AppendStatus::finished);
  EXPECT_EQ(ring.writer.finish({}, {}), AppendStatus::finished);
  RingItem item(2);
  ring.reader.copy(1, item);
  EXPECT_EQ(item.kind, ItemKind::finish);
  EXPECT_EQ(item.condition, ConditionKind::velocity);
  EXPECT_EQ(item.values[2], 3);
  EXPECT_EQ(item.values[3], 4);
}

TEST(WaypointRing, ANewWriterContinuesAfterTheLastWaypoint) {
  MemoryRing ring(1, 4);
  for (int i = 1; i <= 3; ++i)
    ASSERT_EQ(append(ring, i * kMillisecond, {0}), AppendStatus::accepted);
  WaypointRingWriter next(ring.bytes.span(), ring.layout, {});
  EXPECT_EQ(next.written(), 3U);
  EXPECT_FALSE(next.finished());
  EXPECT_EQ(next.last_time(), 3 * kMillisecond);
  const std::vector<double> x{0};
  EXPECT_EQ(next.append({3 * kMillisecond, x, {}, {}}, {}), AppendStatus::duplicate);
  EXPECT_EQ(next.finish({}, {}), AppendStatus::accepted);
  EXPECT_TRUE(WaypointRingWriter(ring.bytes.span(), ring.layout, {}).finished());
}

/// Fills a ring with waypoints every 10 ms. Returns the number of items in it.
Word fill(MemoryRing& ring) {
  while (append(ring, static_cast<std::int64_t>(ring.writer.written() + 1) * 10 * kMillisecond,
                {0}) == AppendStatus::accepted) {
  }
  return ring.writer.written();
}

TEST(WaypointRing, KeepsRoomForStopsAndAFinish) {
  MemoryRing ring(1, 64);
  ASSERT_EQ(fill(ring), 60U);
  const std::vector<double> x{0};
  const Waypoint waypoint{.time = 10'000 * kMillisecond, .position = x};
  const auto stop = [&](Time t) { return ring.writer.replace_from(t, {}, {0, 5 * kMillisecond}); };
  const auto replace = ring.writer.replace_from(9'000 * kMillisecond, {&waypoint, 1}, {});
  EXPECT_EQ(replace, AppendStatus::full);
  // Each stop is earlier than the previous one, so that it needs an item. Stops in the future must
  // leave two items free: for an immediate stop and for a finish.
  EXPECT_EQ(stop(300 * kMillisecond), AppendStatus::accepted);
  EXPECT_EQ(stop(200 * kMillisecond), AppendStatus::accepted);
  EXPECT_EQ(stop(100 * kMillisecond), AppendStatus::full);
  EXPECT_EQ(stop(Time(0)), AppendStatus::accepted);
  for (int i = 0; i < 100; ++i) EXPECT_EQ(stop(Time(i)), AppendStatus::accepted);
  EXPECT_EQ(ring.writer.written(), 63U);
  EXPECT_EQ(ring.writer.finish({}, {}), AppendStatus::accepted);
  EXPECT_EQ(ring.writer.written(), 64U);
}

TEST(WaypointRing, AStopThatRepeatsAQueuedStopTakesNoItem) {
  MemoryRing ring(1, 64);
  ASSERT_EQ(append(ring, 10 * kMillisecond, {0}), AppendStatus::accepted);
  const auto stop = [&](Time t, Word consumed) {
    EXPECT_EQ(ring.writer.replace_from(t, {}, {consumed}), AppendStatus::accepted);
    return ring.writer.written();
  };
  EXPECT_EQ(stop(5 * kMillisecond, 0), 2U);
  EXPECT_EQ(stop(5 * kMillisecond, 1), 2U);
  EXPECT_EQ(stop(7 * kMillisecond, 1), 2U);
  EXPECT_EQ(stop(4 * kMillisecond, 1), 3U);  // earlier
  EXPECT_EQ(stop(4 * kMillisecond, 3), 4U);  // the previous stop is consumed
  ASSERT_EQ(append(ring, 20 * kMillisecond, {0}, 3), AppendStatus::accepted);
  EXPECT_EQ(stop(20 * kMillisecond, 3), 6U);  // a waypoint is in between
  ring.writer = WaypointRingWriter(ring.bytes.span(), ring.layout, {});
  EXPECT_EQ(stop(20 * kMillisecond, 3), 6U);  // also a repeat of the previous producer's stop
}

TEST(WaypointRing, AReplacementThatLeavesNoRoomForAStopIsTooLong) {
  MemoryRing ring(1, 64);
  const std::vector<double> x{0};
  std::vector<Waypoint> waypoints;
  for (int i = 1; i <= 60; ++i) {
    waypoints.push_back({.time = i * kMillisecond, .position = x});
  }
  EXPECT_EQ(ring.writer.replace_from(Time(0), waypoints, {}), AppendStatus::too_many);
  waypoints.pop_back();
  EXPECT_EQ(ring.writer.replace_from(Time(0), waypoints, {}), AppendStatus::accepted);
  EXPECT_EQ(ring.writer.replace_from(Time(-1), {}, {}), AppendStatus::accepted);
}

}  // namespace
}  // namespace splinecast::ipc
