#include <gtest/gtest.h>

#include <cstdint>
#include <random>

#include "tests/fixtures/streams/watched_stream.hpp"

/// How a curve uses waypoints that are late, or refused during the search for an entry.
namespace splinecast::ipc::entries {
namespace {

TEST(Entry, OfALateStreamGivesCountsThatMatchItsSegments) {
  for (const double limit : {0.0, 5.0}) {
    for (std::uint64_t seed = 1; seed <= 6; ++seed) {
      SCOPED_TRACE(::testing::Message() << "limit " << limit << ", seed " << seed);
      std::mt19937_64 random(seed);
      Watched live(limited(limit));
      int ms = 100;
      while (ms < 4000) {
        // Each waypoint is up to 40 ms late or up to 60 ms early.
        live.run_to(ms - 60 + static_cast<int>(random() % 100));
        live.send(ms);
        ms += 20 + static_cast<int>(random() % 20) + (random() % 20 == 0 ? 300 : 0);
      }
      live.end();
      const Summary& summary = live.solver.summary();
      EXPECT_EQ(summary.knots + summary.refused, live.sent.size());
      EXPECT_EQ(live.met(), summary.interpolated());
      expect_continuous(live);
      EXPECT_EQ(live.verified(), "");
      if (limit > 0) {
        EXPECT_LE(live.peak(2), limit * (1 + 1e-6));
      }
    }
  }
}

TEST(Entry, UsesAWaypointUpToAQuarterSecondLateAndRefusesLaterOnes) {
  for (const int late : {1, 100, 250, 251, 400}) {
    Watched live;
    live.send_all(50, 300, 60);
    live.run_to(1000);
    live.send(1005 - late);  // the settled time is 1005
    live.step();
    const Summary& summary = live.solver.summary();
    const bool is_taken = late <= 250;
    EXPECT_EQ(live.reason(Refusal::past), is_taken ? 0U : 1U) << late;
    EXPECT_EQ(summary.refused, is_taken ? 0U : 1U) << late;
    EXPECT_EQ(summary.passed_over, is_taken ? 1U : 0U) << late;
    EXPECT_EQ(summary.knots, is_taken ? 27U : 26U) << late;
  }
}

TEST(Entry, NeverEndsAtALateWaypoint) {
  Watched live;
  live.send_all(50, 300, 60);
  live.run_to(1000);
  const double before = live.position_at(at(1005));
  live.send(900);
  live.step();
  EXPECT_EQ(live.position_at(at(1005)), before);  // settled, therefore unchanged
  live.send_all(1100, 2000, 60);
  live.end();
  EXPECT_EQ(live.met(), live.solver.summary().interpolated());
  EXPECT_EQ(live.verified(), "");
}

TEST(Entry, IgnoresWaypointsRefusedDuringItsSearch) {
  Watched live(limited(1));
  live.send_all(50, 300, 60);
  live.run_to(800);
  live.send(900);
  live.step();
  // The producer below does not recognize these waypoints as duplicate or out of order.
  live.replace_producer();
  const double x = 0.3;
  const auto send_blindly = [&](int ms) {
    WaypointRingWriter blind(live.ring.bytes.span(), live.ring.layout, {.least = Time::min()});
    return blind.append({.time = at(ms), .position = {&x, 1}}, {});
  };
  for (const int ms : {900, 890}) {
    const Word before = live.solver.summary().refused;
    const Word passed = live.solver.summary().passed_over;
    if (send_blindly(ms) != AppendStatus::accepted) continue;
    live.step();
    EXPECT_EQ(live.solver.summary().refused, before + 1) << ms;
    EXPECT_EQ(live.solver.summary().passed_over, passed) << ms;
  }
}

}  // namespace
}  // namespace splinecast::ipc::entries
