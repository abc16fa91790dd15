#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/ipc/solve/watched_stream.hpp"

/// Streams that begin with an entry, and streams that do not.
namespace splinecast::ipc::entries {
namespace {

/// A start from rest whose first interval requires more than the limit, for different numbers of
/// waypoints in the first step.
TEST(Entry, BeginsAStreamWhoseFirstIntervalExceedsItsLimit) {
  for (const double limit : {5.0, 0.0}) {
    for (const int at_once : {2, 8, 31}) {
      SCOPED_TRACE(::testing::Message() << "limit " << limit << ", " << at_once << " in one step");
      Watched live(limited(limit));
      const auto send = [&](int ms) { live.send(ms, 1e-3 * ms); };  // 1 /s from the start
      for (int i = 0; i < at_once; ++i) send(300 + 10 * i);
      live.drain();
      for (int ms = 300 + 10 * at_once; ms <= 2000; ms += 10) {
        live.run_to(ms - 300);
        send(ms);
      }
      live.end();
      const Summary& summary = live.solver.summary();
      EXPECT_GE(summary.passed_over, 1U);
      EXPECT_EQ(live.met(), summary.interpolated());
      ASSERT_FALSE(live.collected.segments().empty());
      EXPECT_NE(live.collected.segments()[0].kind, SegmentKind::spline);
      EXPECT_EQ(live.collected.segments()[0].left, at(300));
      if (limit > 0) {
        EXPECT_LE(live.peak(2), limit * (1 + 1e-6));
      }
      EXPECT_EQ(live.verified(), "");
    }
  }
}

/// A replacement, or a stop, after the first waypoint of a start that has not been compared with
/// the limits yet: it keeps the beginning of that curve.
TEST(Entry, BeginsAStreamThatIsReplacedBeforeItsStartIsDecided) {
  for (const bool in_one_step : {true, false}) {
    for (const std::size_t waypoints : {std::size_t{0}, std::size_t{20}}) {
      SCOPED_TRACE(::testing::Message() << waypoints << " new, in one step: " << in_one_step);
      Watched live(limited(5));
      for (int ms = 300; ms < 370; ms += 10) live.send(ms, 1e-3 * ms);  // 1 /s from the start
      if (!in_one_step) live.step();
      ASSERT_EQ(live.solver.summary().passed_over, 0U);
      const double x = 0.345;
      std::vector<Waypoint> plan;
      for (std::size_t i = 0; i < waypoints; ++i) {
        plan.push_back({.time = at(360 + 10 * static_cast<int>(i)), .position = {&x, 1}});
      }
      ASSERT_EQ(live.ring.writer.replace_from(at(345), plan, live.solved()),
                AppendStatus::accepted);
      live.drain();
      EXPECT_EQ(live.solver.summary().consumed, 8 + waypoints);
      live.run_to(1500);
      live.end();
      EXPECT_LE(live.peak(2, true), 5 * (1 + 1e-6));
      EXPECT_EQ(live.collected.segments()[0].left, at(300));
      EXPECT_NE(live.collected.segments()[0].kind, SegmentKind::spline);
      EXPECT_EQ(live.verified(), "");
    }
  }
}

TEST(Entry, IsNotNeededIfTheStartIsWithinItsLimit) {
  Watched live(limited(5));
  for (int ms = 100; ms <= 1500; ms += 10) {
    live.run_to(ms - 100);
    live.send(ms, 1 - std::cos(1e-3 * (ms - 100)));
  }
  live.end();
  EXPECT_EQ(live.solver.summary().passed_over, 0U);
  EXPECT_EQ(live.entries(), 0U);
  EXPECT_EQ(live.verified(), "");
}

}  // namespace
}  // namespace splinecast::ipc::entries
