#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <vector>

#include "tests/fixtures/streams/watched_stream.hpp"

/// Entries and ends at a bound of the position.
namespace splinecast::ipc::entries {
namespace {

using std::chrono::seconds;

core::WindowOptions bounded(double lower, double upper, double acceleration = 0) {
  core::WindowOptions how = limited(acceleration);
  if (acceleration == 0) how.limits.acceleration.clear();
  how.limits.lower = {lower};
  how.limits.upper = {upper};
  return how;
}

/// The least and the greatest position from a time on, until `after` it.
struct Range {
  double least = INFINITY;
  double greatest = -INFINITY;
};
Range range(Watched& live, Time from, Time after) {
  Range found;
  for (Time t = from; t <= from + after; t += milliseconds(1)) {
    const double x = live.position_at(t);
    found.least = std::min(found.least, x);
    found.greatest = std::max(found.greatest, x);
  }
  return found;
}

/// A line with a speed of 1 up to the bound, which is its last waypoint, at 1,050 ms.
void send_line(Watched& live, int lead) {
  for (int i = 0; i <= 50; ++i) {
    live.run_to(50 + 20 * i - lead);
    live.send(50 + 20 * i, 0.02 * i);
  }
  live.step();
}

TEST(Bounds, AFinishNearThemNeverLeadsFartherThanTheStopThatWasPublished) {
  for (const int late : {-100, -60, -40, -20, -5, 0, 10, 50, 120, 400}) {
    for (const double acceleration : {0.0, 20.0}) {
      SCOPED_TRACE(::testing::Message() << late << " ms, limit " << acceleration);
      Watched live(bounded(0, 1, acceleration));
      send_line(live, 100);
      live.run_to(1050 + late);
      const Range published = range(live, at(1050 + std::min(late, 0)), seconds(5));
      live.end();
      const Range found = range(live, at(1050 + std::min(late, 0)), seconds(10));
      EXPECT_LE(found.greatest, std::max(published.greatest, 1.0) + 1e-9);
      EXPECT_GE(found.least, std::min(published.least, 0.0) - 1e-9);
      EXPECT_EQ(live.position_at(at(12'000)), live.position_at(at(100'000)));
      EXPECT_NE(live.ending(), EndKind::none);
      const bool is_stopped =
          live.ending() == EndKind::stopped || live.ending() == EndKind::in_stop;
      if (!is_stopped) {
        EXPECT_NEAR(live.position_at(at(100'000)), 1, 1e-9);
      }
      EXPECT_EQ(live.solver.summary().end_item, 51U);
      expect_continuous(live);
      EXPECT_EQ(live.verified(), "");
    }
  }
}

TEST(Bounds, ThatAStopPassesCountOnceAsAnExcess) {
  for (const double acceleration : {0.0, 20.0}) {
    SCOPED_TRACE(acceleration);
    Watched live(bounded(0, 1, acceleration));
    send_line(live, 100);
    EXPECT_EQ(live.solver.summary().exceeding, 0U);
    live.run_to(1300);  // the curve has begun the stop after the last waypoint
    EXPECT_EQ(live.solver.summary().exceeding, 1U);
    const auto excess = live.board.reader.worst_excess();
    ASSERT_TRUE(excess);
    EXPECT_EQ(excess->kind, LimitKind::position);
    EXPECT_EQ(excess->item, 50U);
    EXPECT_NEAR(excess->value, live.position_at(at(10'000)), 1e-12);
    EXPECT_GT(excess->value, 1.01);
    EXPECT_EQ(excess->limit, 1);
    live.end();
    EXPECT_EQ(live.solver.summary().exceeding, 1U);
    EXPECT_EQ(live.verified(), "");
  }
}

TEST(Bounds, ALastWaypointOutsideThemIsNotEntered) {
  Watched live(bounded(-10, 10, 5));
  live.send_all(50, 300, 60);
  live.run_to(1500);
  const double rest = live.position_at(at(1500));
  live.send(1600, 12.0);
  live.send(1610, 12.0);
  live.end();
  EXPECT_EQ(live.ending(), EndKind::in_stop);
  EXPECT_EQ(live.solver.summary().end_lateness, Time::zero());
  EXPECT_EQ(live.position_at(at(60'000)), rest);
  EXPECT_EQ(live.solver.summary().passed_over, 2U);
  EXPECT_EQ(live.verified(), "");
}

TEST(Bounds, ThatTheRequestedEndWouldPassAreKept) {
  Watched live(bounded(0, 1, 500));
  for (int i = 0; i <= 20; ++i) {
    live.run_to(100 * i - 1150);
    live.send(50 + 100 * i, i < 20 ? 0.0 : 1.0);  // at rest, then a step
  }
  live.end();
  EXPECT_LE(range(live, at(1950), seconds(10)).greatest, 1 + 1e-9);
  EXPECT_NEAR(live.position_at(at(60'000)), 1, 1e-9);
  EXPECT_EQ(live.verified(), "");
}

TEST(Bounds, ALateEndReportsHowLateItIs) {
  Watched live(bounded(-10, 10, 5));
  live.send_all(50, 800, 60);
  live.run_to(900);
  live.end();
  ASSERT_EQ(live.ending(), EndKind::entered);
  const Summary& summary = live.solver.summary();
  EXPECT_GT(summary.end_lateness, milliseconds(100));
  EXPECT_EQ(summary.end_lateness, summary.settled_until - at(800));
  EXPECT_NEAR(live.position_at(at(800) + summary.end_lateness), motion(at(800)), 1e-9);
}

/// The spline through these waypoints goes as far beyond the last one.
constexpr double kOvershoot = 1e-6;

/// Waypoints that open a gripper from 0 to 0.08, from `from_ms` on, every 20 ms.
void open_gripper(Watched& live, int from_ms) {
  for (int i = 0; i <= 50; ++i) {
    live.run_to(from_ms + 20 * i - 100);
    const double part = i / 50.0;
    live.send(from_ms + 20 * i, 0.08 * part * part * (3 - 2 * part));
  }
  live.run_to(from_ms + 1000);
}

TEST(Bounds, AreEnteredFromAStateOutside) {
  for (const double begin : {-0.0075, -0.0005, 0.0805}) {
    for (const double acceleration : {0.0, 2.0}) {
      SCOPED_TRACE(::testing::Message() << begin << ", limit " << acceleration);
      Watched live(bounded(0, 0.08, acceleration));
      const std::vector<double> zero{0};
      const std::vector<double> x{begin};
      ASSERT_EQ(live.ring.writer.start_from({at(60), x, zero, zero}, live.solved()),
                AppendStatus::accepted);
      open_gripper(live, 200);
      live.end();
      EXPECT_GE(live.met(), 20U);
      const Range found = range(live, at(60), seconds(2));
      EXPECT_GE(found.least, std::min(begin, 0.0) - 1e-9);
      EXPECT_LE(found.greatest, std::max(begin, 0.08) + kOvershoot);
      EXPECT_NEAR(live.position_at(at(60'000)), 0.08, 1e-9);
      EXPECT_EQ(live.verified(), "");
    }
  }
}

TEST(Bounds, AreEnteredAfterAStopThatPassedThem) {
  for (const bool is_replaced : {false, true}) {
    SCOPED_TRACE(is_replaced);
    Watched live(bounded(0, 0.08));
    for (int i = 0; i <= 10; ++i) {  // it closes, and the source ends
      live.run_to(50 + 20 * i - 100);
      const double part = i / 10.0;
      live.send(50 + 20 * i, 0.08 - 0.078 * part * part);
    }
    live.run_to(800);
    const double rest = live.position_at(at(800));
    ASSERT_LT(rest, -0.005);
    if (is_replaced) {
      const double x = 0;
      const Waypoint first{.time = at(890), .position = {&x, 1}};
      ASSERT_EQ(live.ring.writer.replace_from(at(850), {&first, 1}, live.solved()),
                AppendStatus::accepted);
    }
    open_gripper(live, 900);
    live.end();
    EXPECT_GE(live.met(), 35U);
    const Range found = range(live, at(800), seconds(3));
    EXPECT_GE(found.least, rest - 1e-9);
    EXPECT_LE(found.greatest, 0.08 + kOvershoot);
    EXPECT_NEAR(live.position_at(at(60'000)), 0.08, 1e-9);
    EXPECT_EQ(live.verified(), "");
  }
}

}  // namespace
}  // namespace splinecast::ipc::entries
