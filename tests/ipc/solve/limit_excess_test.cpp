#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <string>
#include <vector>

#include "core/limits/check.hpp"
#include "ipc/roles/refusals.hpp"
#include "tests/fixtures/streams/live_stream.hpp"

/// How a solver handles waypoints with which the curve exceeds a limit.
namespace splinecast::ipc {
namespace {

using std::chrono::milliseconds;
using testing::LiveStream;

Time instant(int ms) { return LiveStream::kNow + milliseconds(ms); }

core::WindowOptions step_limits() {
  core::WindowOptions how;
  how.limits.acceleration = {4};
  how.limits.velocity = {2};
  return how;
}

/// A motion within its limits, except for steps of 5 mm at some waypoints.
struct Stepping : LiveStream {
  explicit Stepping(Beyond what) : LiveStream(step_limits()) {
    beyond = what;
    replace_solver();
  }
  void play(const std::vector<int>& steps_at, bool takes_over = false) {
    for (int ms = 50; ms <= 1500; ms += 10) {
      clock.time = instant(ms - 200);
      const bool steps = std::ranges::find(steps_at, ms) != steps_at.end();
      const double position = x(instant(ms)) + (steps ? 0.005 : 0);
      EXPECT_EQ(ring.writer.append({.time = instant(ms), .position = {&position, 1}}, solved()),
                AppendStatus::accepted);
      if (takes_over) replace_solver();
      drain();
    }
  }
  double peak() {
    double peak = 0;
    for (Time t = instant(100); t < instant(1400); t += milliseconds(1)) {
      EXPECT_TRUE(has_values(sampler.preview(t, state.ref())));
      peak = std::max(peak, std::abs(state.acceleration()[0]));
    }
    return peak;
  }
};

TEST(LimitExcess, IsReportedAndTheWaypointIsTaken) {
  Stepping live(Beyond::report);
  live.play({700});
  EXPECT_EQ(live.solver.summary().refused, 0U);
  EXPECT_GT(live.peak(), 100);
  // The step and the return from it.
  ASSERT_GE(live.solver.summary().exceeding, 1U);
  EXPECT_LE(live.solver.summary().exceeding, 8U);
  const auto excess = live.board.reader.excess(live.solver.summary(), 0);
  ASSERT_TRUE(excess);
  EXPECT_EQ(excess->item, 65U);
  EXPECT_FALSE(excess->is_refused);
  EXPECT_EQ(excess->dimension, 0U);
  EXPECT_GT(std::abs(excess->value), excess->limit);
  EXPECT_GE(excess->time, instant(600));
  EXPECT_LE(excess->time, instant(700));
}

TEST(LimitExcess, OfTheLargestRatioIsNamed) {
  Stepping live(Beyond::report);
  live.play({700, 900, 910}, true);
  const auto worst = live.board.reader.worst_excess();
  ASSERT_TRUE(worst);
  const auto ratio = [&](const LimitExcess& e) {
    return core::ratio_of(step_limits().limits, e.kind, e.dimension, e.value, e.limit);
  };
  for (Word i = 0; i < live.solver.summary().exceeding; ++i) {
    const auto excess = live.board.reader.excess(live.solver.summary(), i);
    ASSERT_TRUE(excess);
    EXPECT_GE(ratio(*worst), ratio(*excess));
  }
  EXPECT_TRUE(live.board.reader.excess_of(live.solver.summary(), worst->item));
}

TEST(LimitExcess, IsRefusedWithItsPlaceAndNoExcessIsPublished) {
  for (const bool takes_over : {false, true}) {
    Stepping live(Beyond::refuse);
    live.play({700, 900, 910}, takes_over);
    EXPECT_EQ(live.reason(Refusal::beyond_limits), 3U);
    EXPECT_EQ(live.solver.summary().refused, 3U);
    EXPECT_EQ(live.solver.summary().exceeding, 3U);
    EXPECT_LE(live.peak(), 4 * (1 + 1e-9));
    RefusalReader reader;
    Refusals reported;
    reader.look(live.board.reader, live.ring.reader, reported);
    ASSERT_EQ(reported.items.size(), 3U);
    for (const ItemRefusal& refusal : reported.items) {
      ASSERT_TRUE(refusal.excess);
      EXPECT_TRUE(refusal.excess->is_refused);
      EXPECT_EQ(refusal.excess->item, refusal.item);
      const std::string text = to_string(refusal);
      for (const char* part :
           {"beyond limits", "acceleration of dimension 0 is ", " ns, limit 4"}) {
        EXPECT_NE(text.find(part), std::string::npos) << text;
      }
    }
    EXPECT_EQ(reported.items[0].item, 65U);
  }
}

TEST(LimitExcess, IsNotReportedForAMotionWithinItsLimits) {
  Stepping live(Beyond::refuse);
  live.play({});
  EXPECT_EQ(live.solver.summary().exceeding, 0U);
  EXPECT_EQ(live.solver.summary().refused, 0U);
  EXPECT_EQ(live.solver.summary().passed_over, 0U);
}

/// Waypoints that come so late that the start has settled when the second or third one comes.
TEST(LimitExcess, OfTheFirstIntervalsIsReportedOrRefused) {
  for (const Beyond beyond : {Beyond::report, Beyond::refuse}) {
    for (int steps_at = 1; steps_at <= 4; ++steps_at) {
      for (int lead = 12; lead <= 40; lead += 2) {
        SCOPED_TRACE(::testing::Message() << to_string(beyond) << ", waypoint " << steps_at << ", "
                                          << lead << " ms ahead");
        Stepping live(beyond);
        for (int i = 0; i < 60; ++i) {
          const int ms = 50 + 10 * i;
          const Time next = instant(ms - lead);
          for (; live.clock.time < next; live.clock.time += milliseconds(1)) live.drain();
          const double position = i >= steps_at ? 0.005 : 0;
          ASSERT_EQ(live.ring.writer.append({.time = instant(ms), .position = {&position, 1}},
                                            live.solved()),
                    AppendStatus::accepted);
          live.drain();
        }
        double peak = 0;
        for (Time t = instant(0); t < instant(500); t += milliseconds(1)) {
          EXPECT_TRUE(has_values(live.sampler.preview(t, live.state.ref())));
          peak = std::max(peak, std::abs(live.state.acceleration()[0]));
        }
        const bool keeps_limits = peak <= 4 * (1 + 1e-6);
        EXPECT_TRUE(keeps_limits || beyond == Beyond::report) << peak;
        EXPECT_TRUE(keeps_limits || live.solver.summary().exceeding > 0) << peak;
      }
    }
  }
}

TEST(LimitExcess, IsKeptOnlyIfItIsAmongTheLastOnes) {
  testing::MemoryBoard board(1, 64);
  Summary summary;
  for (Word i = 0; i < kExcessesKept + 10; ++i) {
    board.writer.write_excess(i, {.item = 3 * i,
                                  .kind = LimitKind::jerk,
                                  .dimension = i % kMaxDimensions,
                                  .time = milliseconds(-static_cast<int>(i)),
                                  .value = -1.5 * static_cast<double>(i),
                                  .limit = 2});
  }
  summary.exceeding = kExcessesKept + 10;
  summary.consumed = 3 * summary.exceeding;
  EXPECT_FALSE(board.reader.excess(summary, 9));
  EXPECT_FALSE(board.reader.excess(summary, summary.exceeding));
  for (Word i = 10; i < summary.exceeding; ++i) {
    const auto excess = board.reader.excess(summary, i);
    ASSERT_TRUE(excess) << i;
    EXPECT_EQ(excess->item, 3 * i);
    EXPECT_EQ(excess->kind, LimitKind::jerk);
    EXPECT_EQ(excess->dimension, i % kMaxDimensions);
    EXPECT_EQ(excess->time, milliseconds(-static_cast<int>(i)));
    EXPECT_EQ(excess->value, -1.5 * static_cast<double>(i));
    EXPECT_EQ(excess->limit, 2);
    EXPECT_EQ(board.reader.excess_of(summary, 3 * i)->dimension, excess->dimension);
  }
  EXPECT_FALSE(board.reader.excess_of(summary, 31));
}

}  // namespace
}  // namespace splinecast::ipc
