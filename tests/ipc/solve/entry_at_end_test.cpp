#include <gtest/gtest.h>

#include <chrono>
#include <cmath>

#include "tests/ipc/solve/watched_stream.hpp"

/// Entries to the last waypoint of a stream that finishes after that waypoint has settled.
namespace splinecast::ipc::entries {
namespace {

using std::chrono::seconds;

TEST(Entry, ToTheLastWaypointEndsAStreamThatFinishesAfterIt) {
  for (const int late : {0, 100, 500}) {  // frozen, in the stop segment, and at rest
    for (const double limit : {0.0, 5.0}) {
      SCOPED_TRACE(::testing::Message() << late << " ms late, limit " << limit);
      Watched live(limited(limit));
      live.send_all(50, 800, 60);
      live.run_to(796 + late);
      live.end();
      const Time end = live.solver.summary().settled_until;
      EXPECT_GT(end, at(800));  // after the time of the waypoint
      EXPECT_LT(end, at(800 + late) + seconds(3));
      EXPECT_NEAR(live.position_at(end), motion(at(800)), 1e-12);
      EXPECT_NEAR(live.position_at(end + seconds(5)), motion(at(800)), 1e-12);
      EXPECT_EQ(live.sampler.preview(end + seconds(5), live.state.ref()), SampleStatus::holding);
      if (limit > 0) {
        EXPECT_LE(live.peak(2), limit * (1 + 1e-6));
      }
      expect_continuous(live);
      EXPECT_EQ(live.verified(), "");
    }
  }
}

TEST(Entry, ToTheLastWaypointIsAsLongAsTheLimitRequires) {
  Watched live(limited(1));
  live.send_all(50, 300, 60);
  live.run_to(1500);
  live.send(1600, 30.0);  // far away
  live.send(1610, 30.0);
  live.end();
  const Time end = live.solver.summary().settled_until;
  const double least = std::sqrt(10 / std::sqrt(3.0) * 29.5);
  EXPECT_GT(to_seconds(end - at(1500)), 0.9 * least);
  EXPECT_LT(to_seconds(end - at(1500)), 1.3 * least);
  EXPECT_NEAR(live.position_at(end), 30, 1e-9);
  EXPECT_LE(live.peak(2), 1 + 1e-6);
  EXPECT_EQ(live.verified(), "");
}

}  // namespace
}  // namespace splinecast::ipc::entries
