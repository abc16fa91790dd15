#include "splinecast/ipc/waypoint_ring.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "support/memory_stream.hpp"

namespace splinecast::ipc {
namespace {

using core::Time;
using testing::MemoryRing;

constexpr Time kMillisecond{1'000'000};

AppendStatus append(MemoryRing& ring, Time t, std::vector<double> x, Word consumed = 0) {
  return ring.writer.append({.time = t, .position = x, .velocity = {}, .acceleration = {}},
                            {consumed});
}

TEST(WaypointRing, GivesBackWhatWasAppended) {
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
  EXPECT_EQ(ring.reader.head(), 2U);
}

TEST(WaypointRing, RefusesBadFormWithTheReasonAndCountsIt) {
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
  EXPECT_EQ(ring.writer.head(), 2U);
  EXPECT_EQ(ring.reader.refused(AppendStatus::not_finite), 2U);
  EXPECT_EQ(ring.reader.refused(AppendStatus::wrong_dimension), 2U);
  EXPECT_EQ(ring.reader.refused(AppendStatus::duplicate), 1U);
  EXPECT_EQ(ring.reader.refused(AppendStatus::out_of_order), 1U);
  EXPECT_EQ(ring.reader.refused(AppendStatus::too_close), 1U);
  EXPECT_EQ(ring.reader.refused(AppendStatus::too_far_apart), 1U);
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
    EXPECT_EQ(ring.writer.head() - consumed, 4U);
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
  EXPECT_FALSE(ring.reader.observe(0, item));  // the producer may be writing item 4 over it
  EXPECT_TRUE(ring.reader.observe(1, item));
  EXPECT_EQ(item.values[0], 1);
}

TEST(WaypointRing, APassiveObserverKeepsNoItemThatAReplacementHasBegunToOverwrite) {
  constexpr Word kCapacity = 8;
  constexpr Word kReplaced = 3;
  MemoryRing ring(1, kCapacity);
  RingItem item(1);
  for (int i = 0; i < 8; ++i) {
    ASSERT_EQ(append(ring, Time(10'000 * (i + 1)), {1.0 * i}), AppendStatus::accepted);
  }
  const std::vector<double> x{0};
  std::vector<core::Waypoint> waypoints(kReplaced, {.position = x});
  for (int i = 0; i < 3; ++i)
    waypoints[static_cast<std::size_t>(i)].time = Time(100'000 + 10'000 * i);
  ASSERT_EQ(ring.writer.replace_from(Time(90'000), waypoints, {.consumed = 8}),
            AppendStatus::accepted);
  // Its producer died before it stored `head`, and the next one has only appended one item.
  const auto control = words_at(ring.bytes.span(), ring.layout.control, kHead + 1);
  store(control[kHead], 8, std::memory_order_release);
  WaypointRingWriter next(ring.bytes.span(), ring.layout, {});
  ASSERT_EQ(next.append({Time(100'000), x, {}, {}}, {.consumed = 8}), AppendStatus::accepted);
  for (Word i = 0; i < 8; ++i) EXPECT_EQ(ring.reader.observe(i, item), i > kReplaced) << i;
}

TEST(WaypointRing, NothingFollowsAFinishAndItCarriesItsCondition) {
  MemoryRing ring(2, 4);
  ASSERT_EQ(append(ring, kMillisecond, {1, 2}), AppendStatus::accepted);
  ASSERT_EQ(ring.writer.finish({core::ConditionKind::velocity, {3, 4}}, {}),
            AppendStatus::accepted);
  EXPECT_EQ(append(ring, 2 * kMillisecond, {1, 2}), AppendStatus::finished);
  EXPECT_EQ(ring.writer.finish({}, {}), AppendStatus::finished);
  RingItem item(2);
  ring.reader.copy(1, item);
  EXPECT_EQ(item.kind, ItemKind::finish);
  EXPECT_EQ(item.condition, core::ConditionKind::velocity);
  EXPECT_EQ(item.values[2], 3);
  EXPECT_EQ(item.values[3], 4);
}

TEST(WaypointRing, ANewWriterGoesOnBehindTheLastWaypoint) {
  MemoryRing ring(1, 4);
  for (int i = 1; i <= 3; ++i)
    ASSERT_EQ(append(ring, i * kMillisecond, {0}), AppendStatus::accepted);
  WaypointRingWriter next(ring.bytes.span(), ring.layout, {});
  EXPECT_EQ(next.head(), 3U);
  EXPECT_FALSE(next.finished());
  EXPECT_EQ(next.last_time(), 3 * kMillisecond);
  const std::vector<double> x{0};
  EXPECT_EQ(next.append({3 * kMillisecond, x, {}, {}}, {}), AppendStatus::duplicate);
  EXPECT_EQ(next.finish({}, {}), AppendStatus::accepted);
  EXPECT_TRUE(WaypointRingWriter(ring.bytes.span(), ring.layout, {}).finished());
}

}  // namespace
}  // namespace splinecast::ipc
