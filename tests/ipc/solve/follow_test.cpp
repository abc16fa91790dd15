#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "tests/fixtures/streams/watched_stream.hpp"

/// A stream that keeps its limits by leaving the spline: Beyond::enter.
namespace splinecast::ipc::entries {
namespace {

/// A stream with this action beyond its limits.
struct Following : Watched {
  Following(core::WindowOptions how, Beyond what, bool takes_over = false)
      : Watched(std::move(how), takes_over) {
    beyond = what;
    replace_solver();
  }
  /// Sends positions every 10 ms from 50 ms on, each one 200 ms before its time, and finishes.
  void play(const std::vector<double>& positions) {
    int ms = 50;
    for (const double position : positions) {
      run_to(ms - 200);
      send_or_drop(ms, position);
      ms += 10;
    }
    run_to(ms + 100);
    end();
  }
  void run_to(int ms) {
    for (; clock.time < at(ms); clock.time += milliseconds(1)) {
      step();
      if (now() != (said.empty() ? ipc::Following::meets : said.back())) said.push_back(now());
    }
  }
  [[nodiscard]] ipc::Following now() const { return solver.summary().following(); }
  void send_or_drop(int ms, double position) {
    const WaypointRingWriter::Solved solved{
        .consumed = board.reader.consumed(),
        .refused_until = board.reader.refused_until(board.reader.revision())};
    const auto status = ring.writer.append({.time = at(ms), .position = {&position, 1}}, solved);
    if (status == AppendStatus::accepted) sent.push_back({at(ms), position});
    if (status == AppendStatus::cannot_follow) ++dropped;
    ASSERT_TRUE(status == AppendStatus::accepted || status == AppendStatus::cannot_follow);
  }
  [[nodiscard]] Word refused() const { return reason(Refusal::cannot_follow); }
  std::vector<ipc::Following> said;  ///< each change
  int dropped = 0;                   ///< waypoints that the producer refused
};

core::WindowOptions limits(double velocity, double acceleration) {
  core::WindowOptions how;
  how.limits.velocity = {velocity};
  how.limits.acceleration = {acceleration};
  return how;
}

std::vector<double> slow_sine(std::size_t count) {
  std::vector<double> out(count);
  for (std::size_t i = 0; i < count; ++i) {
    out[i] = 0.5 * (1 - std::cos(0.01 * static_cast<double>(i)));
  }
  return out;
}

void expect_within(Following& live, double velocity, double acceleration) {
  EXPECT_LE(live.peak(1, true), velocity * (1 + 1e-9));
  EXPECT_LE(live.peak(2, true), acceleration * (1 + 1e-9));
  expect_continuous(live);
  EXPECT_EQ(live.verified(), "");
}

TEST(Follow, TakesAMotionWithinItsLimitsAsReportDoes) {
  for (const bool takes_over : {false, true}) {
    Following live(limits(2.5, 12), Beyond::enter, takes_over);
    live.play(slow_sine(300));
    EXPECT_EQ(live.solver.summary().exceeding, 0U);
    EXPECT_EQ(live.solver.summary().passed_over, 0U);
    EXPECT_EQ(live.solver.summary().refused, 0U);
    expect_within(live, 2.5, 12);
  }
}

TEST(Follow, PassesOneWrongWaypointOverAndMeetsThoseAfterIt) {
  for (const bool takes_over : {false, true}) {
    auto positions = slow_sine(300);
    positions[120] += 0.3;
    Following live(limits(2.5, 12), Beyond::enter, takes_over);
    live.play(positions);
    EXPECT_GE(live.solver.summary().exceeding, 1U);
    EXPECT_EQ(live.solver.summary().refused, 0U);
    EXPECT_GE(live.solver.summary().passed_over, 1U);
    EXPECT_LE(live.solver.summary().passed_over, 10U);
    EXPECT_EQ(live.met(), live.sent.size() - live.solver.summary().passed_over);
    expect_within(live, 2.5, 12);
  }
}

TEST(Follow, ReachesAStepThatStays) {
  for (const bool takes_over : {false, true}) {
    auto positions = slow_sine(300);
    for (std::size_t i = 120; i < positions.size(); ++i) positions[i] += 0.3;
    Following live(limits(2.5, 12), Beyond::enter, takes_over);
    live.play(positions);
    EXPECT_EQ(live.solver.summary().refused, 0U);
    // A motion over 0.3 with an acceleration of 12 takes 0.32 s at least.
    EXPECT_GE(live.solver.summary().passed_over, 30U);
    EXPECT_LE(live.solver.summary().passed_over, 60U);
    expect_within(live, 2.5, 12);
  }
}

TEST(Follow, KeepsTheLimitsOfNoisyWaypoints) {
  for (const double noise : {1e-4, 1e-3, 1e-2}) {
    for (const bool takes_over : {false, true}) {
      std::mt19937 random(7);
      std::normal_distribution<double> normal(0, noise);
      auto positions = slow_sine(800);
      for (double& x : positions) x += normal(random);
      Following live(limits(3, 10), Beyond::enter, takes_over);
      live.play(positions);
      EXPECT_GT(live.solver.summary().passed_over, 0U);
      EXPECT_LE(live.met(), live.solver.summary().interpolated());
      expect_within(live, 3, 10);
    }
  }
}

/// A line that is 1.2 times as fast as the limit, and then rests.
std::vector<double> fast_line() {
  std::vector<double> positions(1200);
  for (std::size_t i = 0; i < positions.size(); ++i) {
    positions[i] = 0.012 * static_cast<double>(std::min<std::size_t>(i, 480));
  }
  return positions;
}

TEST(Follow, SaysThatItCannotFollowAndRestsUntilItMeetsAWaypointAgain) {
  for (const bool takes_over : {false, true}) {
    Following live(limits(1, 10), Beyond::enter, takes_over);
    live.play(fast_line());
    const std::vector<ipc::Following> expected{
        ipc::Following::meets_none, ipc::Following::cannot_follow, ipc::Following::meets};
    ASSERT_GE(live.said.size(), expected.size());
    EXPECT_TRUE(std::equal(expected.begin(), expected.end(), live.said.begin()));
    EXPECT_EQ(live.said.back(), ipc::Following::meets);
    EXPECT_GT(live.refused(), 0U);
    EXPECT_GT(live.dropped, 0);
    EXPECT_EQ(live.solver.summary().newest_time, live.sent.back().time);
    expect_within(live, 1, 10);
  }
}

/// Lines up to a bound at many speeds, after a step that makes the curve leave its waypoints: also
/// the stop after the last waypoint keeps the bound, after each number of waypoints.
TEST(Follow, TheStopAfterAnEntryKeepsABound) {
  for (int k = 0; k < 60; ++k) {
    core::WindowOptions how = limits(4, 10);
    how.limits.upper = {1};
    Following live(how, Beyond::enter);
    const double speed = 0.4 + 0.05 * k;  // per second
    double most = 0;
    int ms = 50;
    for (int i = 0; i < 300; ++i, ms += 10) {
      live.run_to(ms - 120);
      const double way = speed * 0.01 * std::max(0, i - 20);
      live.send_or_drop(ms, std::min(way + (i > 24 ? 0.02 : 0), 0.97));
      live.step();
      most = std::max(most, live.position_at(at(60'000)));
    }
    EXPECT_LE(most, 1 + 1e-9) << speed;
    live.end();
    EXPECT_EQ(live.verified(), "");
  }
}

/// With `hermite` an entry from rest may end at the waypoint itself, and the curve follows then.
TEST(Follow, SaysThatItFollowsAfterAnEntryToTheNewestWaypoint) {
  core::WindowOptions how = limits(1, 10);
  how.interpolant.method = find_method("hermite");
  Following live(how, Beyond::enter);
  const auto send = [&](int ms, double position, double velocity) {
    const Waypoint waypoint{.time = at(ms), .position = {&position, 1}, .velocity = {&velocity, 1}};
    return live.ring.writer.append(waypoint, {.consumed = live.board.reader.consumed()});
  };
  int ms = 50;
  for (int i = 0; live.now() != ipc::Following::cannot_follow && i < 1500; ++i, ms += 10) {
    live.run_to(ms - 200);
    (void)send(ms, 0.02 * i, 2);
  }
  ASSERT_EQ(live.now(), ipc::Following::cannot_follow);
  const double there = live.position_at(at(100'000));
  ms += 2000;  // then the curve rests, and has time to reach the next waypoint
  for (int i = 0; i < 600; ++i, ms += 10) {
    live.run_to(ms - 200);
    (void)send(ms, there + 0.01, 0);
  }
  EXPECT_EQ(live.now(), ipc::Following::meets);
  EXPECT_EQ(live.verified(), "");
}

TEST(Follow, IsAsReportWithoutLimits) {
  Following live({}, Beyond::enter);
  live.play(fast_line());
  EXPECT_EQ(live.solver.summary().refused, 0U);
  EXPECT_EQ(live.solver.summary().exceeding, 0U);
  EXPECT_EQ(live.verified(), "");
}

TEST(Follow, AReplacementIsFollowedAgainByACurveThatCouldNot) {
  Following live(limits(1, 10), Beyond::enter);
  int ms = 50;
  for (int i = 0; i < 1000 && live.now() != ipc::Following::cannot_follow; ++i, ms += 10) {
    live.run_to(ms - 200);
    live.send_or_drop(ms, 0.012 * i);
  }
  ASSERT_EQ(live.now(), ipc::Following::cannot_follow);
  const double there = live.position_at(live.clock.time);
  const Time from = live.clock.time + milliseconds(20);
  const Waypoint rest{.time = from + milliseconds(1500), .position = {&there, 1}};
  ASSERT_EQ(live.ring.writer.replace_from(from, {&rest, 1}, live.solved()), AppendStatus::accepted);
  live.run_to(ms + 100);
  EXPECT_EQ(live.now(), ipc::Following::meets);
  EXPECT_EQ(live.board.reader.refused_until(live.board.reader.revision()), Time::max());
}

}  // namespace
}  // namespace splinecast::ipc::entries
