#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <random>

#include "tests/fixtures/streams/watched_stream.hpp"

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

/// Whether a start state in motion, a waypoint and the finish are taken in one step or in several
/// decides nothing about the end.
TEST(Entry, ToTheLastWaypointDoesNotDependOnTheStepThatTakesTheStart) {
  constexpr int kTrials = 400;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> number(-1, 1);
  int entered = 0;
  for (int i = 0; i < kTrials; ++i) {
    core::WindowOptions how = limited(5);
    how.limits.velocity = {0.5};
    how.limits.jerk = {40};
    const double x = number(random);
    const double v = 3 * number(random);
    const double a = 5 * number(random);
    const double goal = 2 * number(random);
    const int ms = 80 + static_cast<int>(200 * std::abs(number(random)));
    const auto play = [&](bool at_once) {
      Watched live(how);
      EXPECT_EQ(live.ring.writer.start_from({at(60), {&x, 1}, {&v, 1}, {&a, 1}}, live.solved()),
                AppendStatus::accepted);
      if (!at_once) live.step();
      live.send(ms, goal);
      live.end();
      EXPECT_EQ(live.verified(), "");
      return live.ending();
    };
    const EndKind end = play(false);
    EXPECT_EQ(play(true), end) << i;
    entered += end == EndKind::in_stop ? 0 : 1;
  }
  EXPECT_GT(entered, kTrials / 4);
  EXPECT_LT(entered, kTrials);
}

}  // namespace
}  // namespace splinecast::ipc::entries
