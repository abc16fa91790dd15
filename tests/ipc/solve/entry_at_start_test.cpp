#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/fixtures/streams/watched_stream.hpp"

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
      for (int ms = 370; ms < 400; ms += 10) live.send(ms, 1e-3 * ms);  // not taken yet
      std::vector<Waypoint> plan;
      for (std::size_t i = 0; i < waypoints; ++i) {
        plan.push_back({.time = at(360 + 10 * static_cast<int>(i)), .position = {&x, 1}});
      }
      ASSERT_EQ(live.ring.writer.replace_from(at(345), plan, live.solved()),
                AppendStatus::accepted);
      for (int i = 0; i < 5; ++i) live.step();
      EXPECT_EQ(live.solver.summary().consumed, 11 + waypoints);
      live.run_to(1500);
      live.end();
      EXPECT_LE(live.peak(2, true), 5 * (1 + 1e-6));
      EXPECT_EQ(live.collected.segments()[0].left, at(300));
      EXPECT_NE(live.collected.segments()[0].kind, SegmentKind::spline);
      EXPECT_EQ(live.verified(), "");
    }
  }
}

/// The solver that published the first waypoints takes no further step before the start.
TEST(Entry, IsNotNeededToStayWithinTheLimitIfTheSolverDiesBeforeTheStartIsDecided) {
  for (const bool takes_over : {true, false}) {
    for (const int waypoints : {2, 3, 7}) {
      SCOPED_TRACE(::testing::Message() << waypoints << " waypoints, takes over: " << takes_over);
      Watched live(limited(5));
      for (int i = 0; i < waypoints; ++i) live.send(300 + 10 * i, 5e-3 * i);  // 0.5 /s
      live.step();
      EXPECT_EQ(live.course(), Course::starting);
      EXPECT_EQ(live.solver.summary().passed_over, 0U);
      for (int ms = 0; ms <= 1000; ++ms) ASSERT_EQ(live.position_at(at(ms)), 0) << ms;
      live.clock.time = at(330);  // the start has settled
      if (takes_over) live.replace_solver();
      live.step();
      EXPECT_EQ(live.position_at(live.clock.time), 0);
      for (int ms = 300 + 10 * waypoints; ms <= 1500; ms += 10) {
        live.run_to(std::max(ms - 50, 330));
        live.send(ms, 5e-4 * (ms - 300));
      }
      live.end();
      EXPECT_LE(live.peak(2, true), 5 * (1 + 1e-6));
      EXPECT_GT(live.met(), 50U);
      EXPECT_EQ(live.verified(), "");
    }
  }
}

/// A start that exceeds its limit with two waypoints, but not with more of them.
TEST(Entry, IsNotNeededIfTheStartIsWithinItsLimitOnceMoreWaypointsAreKnown) {
  for (const bool takes_over : {true, false}) {
    for (const int at_once : {1, 3}) {
      SCOPED_TRACE(::testing::Message() << at_once << " in one step, takes over: " << takes_over);
      Watched live(limited(30), takes_over);
      Watched together(limited(30));
      const auto send = [](Watched& to, int i) { to.send(300 + 10 * i, 1e-3 * i * i); };  // 20 /s²
      int starts = 0;
      for (int i = 0; i < 30; ++i) {
        send(live, i);
        send(together, i);
        if ((i + 1) % at_once == 0) live.step();
        starts += live.course() == Course::starting ? 1 : 0;
      }
      EXPECT_EQ(starts, at_once == 1 ? 1 : 0);
      together.step();
      for (Watched* stream : {&live, &together}) {
        stream->run_to(600);
        stream->end();
        EXPECT_EQ(stream->verified(), "");
        EXPECT_EQ(stream->solver.summary().passed_over, 0U);
        EXPECT_EQ(stream->collected.segments()[0].kind, SegmentKind::spline);
      }
      const auto a = live.collected.segments();
      const auto b = together.collected.segments();
      ASSERT_EQ(a.size(), b.size());
      for (std::size_t i = 0; i < 20; ++i) {
        ASSERT_EQ(a[i].left, b[i].left) << i;
        ASSERT_EQ(a[i].coefficients, b[i].coefficients) << i;
      }
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
