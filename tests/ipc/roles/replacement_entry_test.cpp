#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <optional>
#include <vector>

#include "ipc/roles/internals.hpp"
#include "ipc/roles/replace_preview.hpp"
#include "ipc/verification/settled_segments.hpp"
#include "splinecast/producer.hpp"
#include "splinecast/reader.hpp"
#include "splinecast/solver.hpp"
#include "tests/fixtures/processes/process.hpp"
#include "tests/fixtures/streams/live_stream.hpp"

/// The entry of a replacement onto its waypoints: it does not end before the blend ends, and it is
/// the one that the preview reports.
namespace splinecast::ipc {
namespace {

using std::chrono::milliseconds;
using testing::LiveStream;

Time time_at(int ms) { return LiveStream::kNow + milliseconds(ms); }

core::WindowOptions acceleration_limit(double acceleration) {
  core::WindowOptions how;
  if (acceleration > 0) how.limits.acceleration = {acceleration};
  return how;
}

/// A stream in motion at 1 s, and a plan that replaces its future from 1.1 s on.
struct Replaced : LiveStream {
  explicit Replaced(double limit = 0, double offset = 0.02)
      : LiveStream(acceleration_limit(limit)) {
    for (int ms = 50; ms <= 1300; ms += 10) {
      clock.time = time_at(std::max(ms - 250, 0));
      EXPECT_EQ(put(time_at(ms)), AppendStatus::accepted);
      drain();
    }
    clock.time = time_at(1000);
    drain();
    for (int ms = 1110; ms <= 2000; ms += 10) {
      times.push_back(time_at(ms));
      positions.push_back(x(time_at(ms)) + offset);
    }
    for (std::size_t i = 0; i < times.size(); ++i) {
      plan.push_back({.time = times[i], .position = std::span(&positions[i], 1)});
    }
  }
  ReplacePreview preview(Time blend) {
    ReplacementPlanner planner(board.reader, window, kinds, live, Beyond::report);
    ReplacePreview out;
    out.begin = time_at(1100);
    planner.plan(plan, blend, out);
    return out;
  }
  /// Replaces the future and returns its entry. With `takes_over`, a new solver makes each step.
  std::optional<SegmentCopy> replace(Time blend, bool takes_over = false) {
    EXPECT_EQ(ring.writer.replace_from(time_at(1100), plan, solved(), blend),
              AppendStatus::accepted);
    for (int i = 0; i < 100; ++i) {
      if (takes_over) replace_solver();
      solver.step(clock);
    }
    drain();
    BoardSegment segment(1, false);
    SegmentCopy found;
    for (Word n = solver.summary().run; n <= solver.summary().newest; ++n) {
      if (segment.take(board.reader, solver.summary(), n) != BoardSegment::Taken::whole) continue;
      segment.copy_to(found);
      if (found.kind == SegmentKind::entry) return found;
    }
    return std::nullopt;
  }

  std::vector<Time> times;
  std::vector<double> positions;
  std::vector<Waypoint> plan;
};

TEST(ReplacementEntry, DoesNotEndBeforeItsBlendEnds) {
  for (const bool takes_over : {false, true}) {
    for (const int blend : {0, 5, 14, 100, 333, 890}) {
      Replaced live(20);
      const auto entry = live.replace(milliseconds(blend), takes_over);
      ASSERT_TRUE(entry) << blend;
      EXPECT_EQ(entry->left, time_at(1100));
      EXPECT_GE(entry->right - entry->left, milliseconds(blend));
      EXPECT_LT(entry->right - entry->left, milliseconds(std::max(blend, 200) + 20)) << blend;
      const auto passed =
          std::ranges::count_if(live.times, [&](Time t) { return t < entry->right; });
      EXPECT_EQ(live.solver.summary().passed_over, static_cast<Word>(passed)) << blend;
    }
  }
}

TEST(ReplacementEntry, EndsAfterTheLastWaypointForALongerBlend) {
  Replaced live(20);
  const auto entry = live.replace(milliseconds(1500));
  ASSERT_TRUE(entry);
  EXPECT_GE(entry->right - entry->left, milliseconds(1500));
  EXPECT_EQ(live.solver.summary().passed_over, live.plan.size());
}

TEST(ReplacementEntry, RefusesABlendBeyondTheLargestIntervalAndTreatsANegativeOneAsZero) {
  Replaced live;
  EXPECT_EQ(
      live.ring.writer.replace_from(time_at(1100), live.plan, live.solved(), std::chrono::hours(2)),
      AppendStatus::too_far_apart);
  const auto entry = live.replace(milliseconds(-7));
  ASSERT_TRUE(entry);
  EXPECT_EQ(live.solver.summary().controls, 1U);
}

TEST(ReplacementPreview, ReportsTheEntryThatTheSolverMakes) {
  for (const double limit : {0.0, 3.0, 20.0}) {
    for (const int blend : {0, 100, 400, 1500}) {
      SCOPED_TRACE(::testing::Message() << "limit " << limit << ", blend " << blend);
      Replaced live(limit);
      const Word revision = live.board.reader.revision();
      const ReplacePreview reported = live.preview(milliseconds(blend));
      EXPECT_EQ(live.board.reader.revision(), revision);
      ASSERT_TRUE(reported.is_known);
      ASSERT_TRUE(reported.enters);
      const auto entry = live.replace(milliseconds(blend));
      ASSERT_TRUE(entry);
      EXPECT_EQ(reported.begin, entry->left);
      EXPECT_EQ(reported.duration, entry->right - entry->left);
      EXPECT_EQ(reported.passed_over, live.solver.summary().passed_over);
      if (reported.waypoint) {
        EXPECT_EQ(live.times[*reported.waypoint], entry->right);
      }
      double peak = 0;
      for (Time t = entry->left; t < entry->right; t += milliseconds(1)) {
        ASSERT_TRUE(has_values(live.sampler.preview(t, live.state.ref())));
        peak = std::max(peak, std::abs(live.state.acceleration()[0]));
      }
      EXPECT_NEAR(reported.entry.acceleration[0], peak, 0.02 * peak);
      EXPECT_GE(reported.motion.acceleration[0], reported.entry.acceleration[0]);
      EXPECT_GE(reported.motion.velocity[0], reported.entry.velocity[0]);
      EXPECT_GT(reported.entry.jerk[0], 0);
      if (limit > 0) {
        EXPECT_LE(reported.worst.ratio, 1 + 1e-9);
        EXPECT_GT(reported.worst.ratio, 0.05);
      }
    }
  }
}

TEST(ReplacementPreview, OfAStopReportsItsDuration) {
  Replaced live(4);
  live.plan.clear();
  const ReplacePreview reported = live.preview({});
  ASSERT_TRUE(reported.is_known);
  EXPECT_FALSE(reported.enters);
  EXPECT_EQ(live.ring.writer.replace_from(time_at(1100), {}, live.solved()),
            AppendStatus::accepted);
  live.drain();
  EXPECT_EQ(live.solver.summary().stop, reported.duration);
}

/// Positions at 100 Hz of a motion with two dimensions; the second one is periodic.
std::vector<std::array<double, 2>> positions_from(Time first, std::size_t count, double offset) {
  std::vector<std::array<double, 2>> positions;
  for (std::size_t i = 0; i < count; ++i) {
    const double s = to_seconds(first) + 0.01 * static_cast<double>(i);
    positions.push_back({0.3 * std::sin(s) + offset, std::remainder(0.8 * s, 6.0)});
  }
  return positions;
}

/// The positions as waypoints, 10 ms apart; `positions` must outlive the result.
std::vector<Waypoint> waypoints_at(const std::vector<std::array<double, 2>>& positions,
                                   Time first) {
  std::vector<Waypoint> waypoints;
  for (const auto& position : positions) {
    waypoints.push_back({.time = first, .position = position});
    first += milliseconds(10);
  }
  return waypoints;
}

TEST(ReplacementPreview, OfAProducerChangesNothingAndMatchesTheReplacement) {
  const testing::TestStream stream;
  Producer producer(stream.name(),
                    {.dimensions = 2, .kinds = {{}, {DimensionKind::periodic, 6.0}}});
  Solver solver(stream.name(), {.limits = MotionLimits{.acceleration = {20}}});
  const MonotonicClock clock;
  EXPECT_FALSE(producer.preview_replace(clock.now(), {}).is_known);
  ASSERT_TRUE(solver.attach());
  const Time begin = clock.now() + milliseconds(200);
  const auto motion = positions_from({}, 100, 0);
  for (const Waypoint& waypoint : waypoints_at(motion, begin)) {
    ASSERT_EQ(producer.append(waypoint), AppendStatus::accepted);
  }
  while (solver.step(clock).consumed > 0) continue;
  const Time t = begin + milliseconds(500);
  const auto other = positions_from(milliseconds(520), 60, 0.01);
  const auto plan = waypoints_at(other, t + milliseconds(20));
  const Word appended = producer.appended();
  const Word passed_before = Internals::summary(solver).passed_over;  // > 0: starts in motion
  const ReplacePreview reported = producer.preview_replace(t, plan, {.blend = milliseconds(100)});
  EXPECT_EQ(producer.appended(), appended);
  ASSERT_EQ(reported.status, AppendStatus::accepted);
  ASSERT_TRUE(reported.is_known);
  ASSERT_TRUE(reported.enters);
  EXPECT_GE(reported.duration, milliseconds(100));
  EXPECT_LE(reported.entry.acceleration[0], 20);
  EXPECT_LT(reported.motion.velocity[1], 5);
  EXPECT_EQ(producer.preview_replace(begin - std::chrono::hours(1), plan).status,
            AppendStatus::too_late);
  ASSERT_EQ(producer.replace_from(t, plan, {.blend = milliseconds(100)}), AppendStatus::accepted);
  for (int i = 0; i < 100; ++i) solver.step(clock);
  EXPECT_EQ(Internals::summary(solver).passed_over - passed_before, reported.passed_over);
  Reader reader(stream.name());
  State state(2);
  ASSERT_TRUE(has_values(reader.preview(t + reported.duration / 2, state)));
  EXPECT_LT(reader.excess(state).ratio, 1);
  EXPECT_GT(reader.excess(state).ratio, 0);
  EXPECT_EQ(reader.limits().acceleration.size(), 2U);
}

TEST(ReplacementPreview, IsUnknownForAStreamWithoutACurve) {
  LiveStream live;
  ReplacementPlanner planner(live.board.reader, live.window, live.kinds, live.live, Beyond::report);
  ReplacePreview reported;
  reported.begin = time_at(100);
  planner.plan({}, {}, reported);
  EXPECT_FALSE(reported.is_known);
}

}  // namespace
}  // namespace splinecast::ipc
