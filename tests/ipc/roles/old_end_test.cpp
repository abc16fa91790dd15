#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "splinecast/clock.hpp"
#include "splinecast/errors.hpp"
#include "splinecast/producer.hpp"
#include "splinecast/reader.hpp"
#include "splinecast/solver.hpp"
#include "splinecast/streams.hpp"
#include "tests/fixtures/processes/process.hpp"

/// A live stream that is created again starts where the earlier one has left the machine. Uses real
/// regions and CLOCK_MONOTONIC.
namespace splinecast {
namespace {

using namespace std::chrono_literals;
using Values = std::vector<double>;

constexpr std::array<double, 1> kZero{};
constexpr Condition kHalt{.kind = ConditionKind::halt, .value = {}};

class OldEnd : public ::testing::Test {
 protected:
  static Time now() { return MonotonicClock().now(); }

  Producer producer(const ProducerOptions& options = {}) { return {stream_.name(), options}; }

  static AppendStatus append(Producer& producer, Time t, const Values& x) {
    return producer.append({.time = t, .position = x});
  }

  /// A state at rest. Valid until the next call.
  Instant at_rest(const Values& x) {
    position_ = x;
    return {.time = now() + 20ms, .position = position_, .velocity = kZero, .acceleration = kZero};
  }

  /// Steps the solver until `done`; it attaches to each stream of its name.
  template <typename Done>
  void solve_until(Solver& solver, const Done& done) {
    const MonotonicClock clock;
    const Time end = now() + 20s;
    while (!done()) {
      ASSERT_LT(now(), end);
      if (solver.attached() || solver.attach()) solver.step(clock);
      std::this_thread::sleep_for(200us);
    }
  }

  /// A producer of the stream, to which the solver has attached.
  Producer attached_producer(Solver& solver, const ProducerOptions& options = {}) {
    Producer made = producer(options);
    solve_until(solver, [&] { return made.wait_for_solver(Time(0)); });
    attached_ = now();
    return made;
  }

  /// A stream from `from` to `to`, finished and at rest.
  void leave(Solver& solver, const Values& from, const Values& to, ProducerOptions options = {}) {
    options.dimensions = from.size();
    Producer first = attached_producer(solver, options);
    const Time t = now() + 20ms;
    if (!first.old_end().position.empty()) {
      ASSERT_EQ(first.start_from({.position = from}, {.moved = true}), AppendStatus::accepted);
    }
    ASSERT_EQ(append(first, t, from), AppendStatus::accepted);
    ASSERT_EQ(append(first, t + 50ms, to), AppendStatus::accepted);
    ASSERT_EQ(first.finish(kHalt), AppendStatus::accepted);
    solve_until(solver, [&] { return now() > t + 60ms; });
  }

  /// Samples the stream every step until `end`, and compares it with the bound of its velocity. It
  /// was at `first` when the last producer attached, and may have begun to move since then.
  /// Returns the last position.
  double follow(Solver& solver, Time end, double first, double fastest) {
    Reader reader(stream_.name());
    State state(1);
    double last = first;
    Time before = attached_;
    solve_until(solver, [&] {
      const Time t = now();
      if (!has_values(reader.sample(t, state))) return t > end;
      const double x = state.position()[0];
      EXPECT_LE(std::abs(x - last), fastest * to_seconds(t - before) + 1e-9) << to_seconds(t);
      last = x;
      before = t;
      return t > end;
    });
    return last;
  }

  testing::TestStream stream_;
  Values position_;
  Time attached_{};
};

TEST_F(OldEnd, AFirstWaypointElsewhereIsRefusedWithBothPositions) {
  Solver solver(stream_.name(), {});
  leave(solver, {0}, {0.4});
  Producer again = attached_producer(solver, {.names = {"lift"}});
  const Values there{-0.4};
  const Waypoint first{.time = now() + 1s, .position = there};
  EXPECT_EQ(again.append(first), AppendStatus::elsewhere);
  EXPECT_EQ(again.replace_from(now() + 100ms, {&first, 1}), AppendStatus::elsewhere);
  EXPECT_EQ(again.appended(), 0U);
  const std::string why = again.why_elsewhere(first);
  for (const char* part : {"(0.4)", "(-0.4)", "0.8 away", "tolerance 0.001", "old end", "moved"}) {
    EXPECT_NE(why.find(part), std::string::npos) << part << ": " << why;
  }
  EXPECT_EQ(append(again, now() + 200ms, {0.4009}), AppendStatus::accepted);
  EXPECT_EQ(again.appended(), 1U);
  EXPECT_TRUE(again.why_elsewhere(first).empty());
}

TEST_F(OldEnd, AnEntryLeadsFromItToAWaypointWithinTheLimits) {
  constexpr double kFastest = 1;
  SolverOptions how;
  how.limits = MotionLimits{.velocity = {kFastest}, .acceleration = {20}};
  Solver solver(stream_.name(), how);
  leave(solver, {0.38}, {0.4});
  Producer again = attached_producer(solver);
  // 0.2 at most 1/s takes 0.375 s from rest to rest.
  EXPECT_EQ(append(again, now() + 300ms, {0.2}), AppendStatus::elsewhere);
  const Values x{0.2};
  EXPECT_NE(again.why_elsewhere({.time = now() + 300ms, .position = x}).find("takes 0.375 s"),
            std::string::npos);
  const Time t = now() + 600ms;
  ASSERT_EQ(append(again, t, {0.2}), AppendStatus::accepted);
  EXPECT_EQ(again.appended(), 2U);
  ASSERT_EQ(append(again, t + 100ms, {0.2}), AppendStatus::accepted);
  ASSERT_EQ(again.finish(kHalt), AppendStatus::accepted);
  solve_until(solver, [&] { return again.wait_until_consumed(Time(0)); });
  EXPECT_NEAR(follow(solver, t + 150ms, 0.4, kFastest * 1.01), 0.2, 1e-9);
}

TEST_F(OldEnd, AReplacementStartsTheStreamInTheSameWay) {
  SolverOptions how;
  how.limits = MotionLimits{.velocity = {1}, .acceleration = {20}};
  Solver solver(stream_.name(), how);
  leave(solver, {0.38}, {0.4});
  Producer again = attached_producer(solver);
  const Time t = now() + 700ms;
  const Values x{0.2};
  const std::array way{Waypoint{.time = t, .position = x},
                       Waypoint{.time = t + 50ms, .position = x}};
  EXPECT_EQ(again.replace_from(t - 300ms, way), AppendStatus::elsewhere);
  ASSERT_EQ(again.replace_from(t - 500ms, way), AppendStatus::accepted);
  EXPECT_EQ(again.appended(), 4U);
  ASSERT_EQ(again.finish(kHalt), AppendStatus::accepted);
  solve_until(solver, [&] { return again.wait_until_consumed(Time(0)); });
  EXPECT_TRUE(again.refusals().items.empty());
  EXPECT_NEAR(follow(solver, t + 100ms, 0.4, 1.01), 0.2, 1e-9);
}

TEST_F(OldEnd, AStartStateNearItIsMeasured) {
  Solver solver(stream_.name(), {});
  leave(solver, {0}, {0.4});
  Producer again = attached_producer(solver);
  EXPECT_EQ(again.start_from(at_rest({0.9})), AppendStatus::elsewhere);
  ASSERT_EQ(again.start_from(at_rest({0.4005})), AppendStatus::accepted);
  EXPECT_TRUE(again.old_end().position.empty());
  EXPECT_EQ(append(again, now() + 1s, {-0.4}), AppendStatus::accepted);
}

TEST_F(OldEnd, IsAStateToStartFrom) {
  Solver solver(stream_.name(), {});
  leave(solver, {0}, {0.4});
  Producer again = attached_producer(solver);
  const Instant end = again.old_end();
  ASSERT_EQ(end.position.size(), 1U);
  EXPECT_NEAR(end.position[0], 0.4, 1e-12);
  ASSERT_EQ(again.start_from(end), AppendStatus::accepted);
  const Time t = now() + 300ms;
  ASSERT_EQ(append(again, t, {-0.4}), AppendStatus::accepted);
  ASSERT_EQ(again.finish(kHalt), AppendStatus::accepted);
  solve_until(solver, [&] { return again.wait_until_consumed(Time(0)); });
  // Without limits it may take as long as a motion from rest to rest in 1 s requires.
  EXPECT_NEAR(follow(solver, t + 2s, 0.4, 10), -0.4, 1e-9);
}

TEST_F(OldEnd, DoesNotCountIfTheMachineWasMoved) {
  Solver solver(stream_.name(), {});
  leave(solver, {0}, {0.4});
  const Values far{0.9};
  {
    Producer again = attached_producer(solver);
    ASSERT_EQ(again.start_from({.position = far}, {.moved = true}), AppendStatus::accepted);
    EXPECT_EQ(again.appended(), 0U);
    EXPECT_EQ(append(again, now() + 1s, {0.4}), AppendStatus::elsewhere);
    EXPECT_EQ(append(again, now() + 1s, far), AppendStatus::accepted);
    ASSERT_EQ(again.finish(kHalt), AppendStatus::accepted);
    EXPECT_EQ(again.start_from({.position = far}, {.moved = true}), AppendStatus::finished);
    solve_until(solver, [&] { return again.wait_until_consumed(Time(0)); });
  }
  Producer again = attached_producer(solver);
  ASSERT_EQ(again.start_from(at_rest({0}), {.moved = true}), AppendStatus::accepted);
  EXPECT_EQ(again.start_from(at_rest({0}), {.moved = true}), AppendStatus::already_started);
}

TEST_F(OldEnd, IsKeptWhileNoStreamHasStarted) {
  Solver solver(stream_.name(), {});
  leave(solver, {0}, {0.4});
  for (int i = 0; i < 3; ++i) {
    Producer again = attached_producer(solver);
    EXPECT_EQ(append(again, now() + 1s, {0}), AppendStatus::elsewhere);
    if (i == 0) again.withdraw();
    if (i == 1) {
      ASSERT_EQ(again.finish(kHalt), AppendStatus::accepted);
      solve_until(solver, [&] { return again.wait_until_consumed(Time(0)); });
    }
    // The third producer dies, and the next one continues its ring.
  }
  Producer again = producer();
  EXPECT_EQ(append(again, now() + 1s, {0}), AppendStatus::elsewhere);
  EXPECT_NEAR(again.old_end().position[0], 0.4, 1e-12);
}

TEST_F(OldEnd, IsNotAskedWhereItIsOfAnotherMachineOrRemoved) {
  {
    Solver solver(stream_.name(), {});
    leave(solver, {0}, {0.4});
  }
  const auto has_end = [&](const ProducerOptions& options) {
    Producer other = producer(options);
    const bool has = !other.old_end().position.empty();
    other.withdraw();
    return has;
  };
  EXPECT_TRUE(has_end({}));
  EXPECT_FALSE(has_end({.dimensions = 2}));
  EXPECT_FALSE(has_end({.kinds = {{.kind = DimensionKind::periodic, .period = 1}}}));
  EXPECT_FALSE(has_end({.clock = StreamClock::recorded}));
  EXPECT_TRUE(has_end({}));
  remove_stream(stream_.name());
  EXPECT_FALSE(has_end({}));
}

TEST_F(OldEnd, IsComparedAsItsKindRequires) {
  Solver solver(stream_.name(), {});
  constexpr double kTurn = 2 * std::numbers::pi;
  ProducerOptions options{.dimensions = 5};
  options.kinds.assign(5, {.kind = DimensionKind::quaternion});
  options.kinds[0] = {.kind = DimensionKind::periodic, .period = kTurn};
  leave(solver, {3.0, 0, 0, 0, 1}, {3.14, 0, 0, std::sin(0.05), std::cos(0.05)}, options);
  Producer again = attached_producer(solver, options);
  const auto at = [&](double turn, double angle, double sign) {
    return Values{turn, 0, 0, sign * std::sin(angle / 2), sign * std::cos(angle / 2)};
  };
  EXPECT_EQ(append(again, now() + 1s, at(-3.14, 0.1, 1)), AppendStatus::elsewhere);
  EXPECT_EQ(append(again, now() + 1s, at(3.14, 0.102, 1)), AppendStatus::elsewhere);
  EXPECT_EQ(append(again, now() + 1s, at(3.14 - kTurn, 0.1005, -1)), AppendStatus::accepted);
}

TEST_F(OldEnd, IsNotKnownBeforeTheOldSolverHasTakenTheEnd) {
  Solver solver(stream_.name(), {});
  Time end{};
  {
    Producer first = attached_producer(solver);
    end = now() + 60ms;
    ASSERT_EQ(append(first, now() + 20ms, {0}), AppendStatus::accepted);
    solve_until(solver, [&] { return first.wait_until_consumed(Time(0)); });
    ASSERT_EQ(append(first, end, {0.01}), AppendStatus::accepted);
    ASSERT_EQ(first.finish(kHalt), AppendStatus::accepted);
  }
  Producer again = producer();
  const Values x{0};
  EXPECT_TRUE(again.old_end().position.empty());
  EXPECT_EQ(again.append({.time = now() + 1s, .position = x}), AppendStatus::elsewhere);
  EXPECT_NE(again.why_elsewhere({.time = now() + 1s, .position = x}).find("wait for a solver"),
            std::string::npos);
  solve_until(solver, [&] { return again.wait_for_solver(Time(0)); });
  EXPECT_GE(now(), end);
  EXPECT_EQ(append(again, now() + 1s, {0.01}), AppendStatus::accepted);
}

TEST_F(OldEnd, IsNotKnownBeforeTheOldCurveHasBegun) {
  Solver solver(stream_.name(), {});
  {
    Producer first = attached_producer(solver);
    ASSERT_EQ(append(first, now() + 20ms, {0.25}), AppendStatus::accepted);
    ASSERT_EQ(first.finish(kHalt), AppendStatus::accepted);
  }
  Producer again = producer();
  EXPECT_EQ(append(again, now() + 1s, {0}), AppendStatus::elsewhere);
  solve_until(solver, [&] { return again.wait_for_solver(Time(0)); });
  EXPECT_EQ(append(again, now() + 1s, {0}), AppendStatus::elsewhere);
  EXPECT_EQ(append(again, now() + 1s, {0.25}), AppendStatus::accepted);
}

TEST_F(OldEnd, AStreamThatNeverBeganHasNone) {
  Solver solver(stream_.name(), {});
  {
    Producer first = attached_producer(solver);
    ASSERT_EQ(first.finish(kHalt), AppendStatus::accepted);
  }
  Producer again = producer();
  EXPECT_EQ(append(again, now() + 1s, {3}), AppendStatus::elsewhere);  // until a solver attaches
  solve_until(solver, [&] { return again.wait_for_solver(Time(0)); });
  EXPECT_TRUE(again.old_end().position.empty());
  EXPECT_EQ(append(again, now() + 1s, {3}), AppendStatus::accepted);
}

TEST_F(OldEnd, AFirstWaypointWithAShortLeadStartsThereByAnEntry) {
  Solver solver(stream_.name(), {});
  leave(solver, {0}, {0.4});
  Producer again = attached_producer(solver);
  const Time t = now() + 1ms;
  ASSERT_EQ(append(again, t, {0.4}), AppendStatus::accepted);
  EXPECT_EQ(again.appended(), 2U);
  ASSERT_EQ(append(again, t + 400ms, {0.5}), AppendStatus::accepted);
  ASSERT_EQ(again.finish(kHalt), AppendStatus::accepted);
  std::this_thread::sleep_for(20ms);
  solve_until(solver, [&] { return again.wait_until_consumed(Time(0)); });
  EXPECT_TRUE(again.refusals().items.empty());
  EXPECT_NEAR(follow(solver, t + 2s, 0.4, 2), 0.5, 1e-9);
}

TEST_F(OldEnd, IsKeptIfTheFirstWaypointIsTooLateForTheSolver) {
  Solver solver(stream_.name(), {});
  leave(solver, {0}, {0.4});
  {
    Producer again = attached_producer(solver);
    const Time t = now() + 150ms;
    ASSERT_EQ(append(again, t, {0.4}), AppendStatus::accepted);
    ASSERT_EQ(append(again, t + 400ms, {0.5}), AppendStatus::accepted);
    const Values x{0.6};
    const std::array way{Waypoint{.time = t + 700ms, .position = x}};
    ASSERT_EQ(again.replace_from(t + 600ms, way), AppendStatus::accepted);
    ASSERT_EQ(again.finish(kHalt), AppendStatus::accepted);
    std::this_thread::sleep_for(200ms);  // the solver is stopped
    solve_until(solver, [&] { return again.wait_until_consumed(Time(0)); });
    const Refusals found = again.refusals();
    ASSERT_EQ(found.items.size(), 4U);
    for (const ItemRefusal& refused : found.items) EXPECT_EQ(refused.reason, Refusal::past);
  }
  Producer again = attached_producer(solver);
  EXPECT_EQ(append(again, now() + 1s, {0.5}), AppendStatus::elsewhere);
  EXPECT_EQ(append(again, now() + 1s, {0.4}), AppendStatus::accepted);
}

TEST_F(OldEnd, AStartStateThatComesLateBeginsAsEarlyAsPossible) {
  Solver solver(stream_.name(), {});
  Producer first = producer();
  const Values x{1};
  const Values zero{0};
  const Time t = now() + 1ms;
  ASSERT_EQ(first.start_from({.time = t, .position = x, .velocity = zero, .acceleration = zero}),
            AppendStatus::accepted);
  ASSERT_EQ(append(first, t + 2ms, {1}), AppendStatus::accepted);
  ASSERT_EQ(append(first, t + 400ms, {1.1}), AppendStatus::accepted);
  ASSERT_EQ(append(first, t + 500ms, {1.1}), AppendStatus::accepted);
  ASSERT_EQ(first.finish(kHalt), AppendStatus::accepted);
  std::this_thread::sleep_for(50ms);
  solve_until(solver, [&] { return first.wait_until_consumed(Time(0)); });
  EXPECT_TRUE(first.refusals().items.empty());
  EXPECT_NEAR(follow(solver, t + 550ms, 1, 2), 1.1, 1e-9);
}

TEST_F(OldEnd, AStopBeforeTheFirstWaypointDoesNotStartTheStream) {
  SolverOptions how;
  how.limits = MotionLimits{.velocity = {1}, .acceleration = {20}};
  Solver solver(stream_.name(), how);
  leave(solver, {0.38}, {0.4});
  Producer again = attached_producer(solver);
  ASSERT_EQ(again.replace_from(Time::min(), {}), AppendStatus::accepted);
  EXPECT_EQ(append(again, now() + 10ms, {0.2}), AppendStatus::elsewhere);
  const Time t = now() + 500ms;
  ASSERT_EQ(append(again, t, {0.3}), AppendStatus::accepted);
  ASSERT_EQ(again.finish(kHalt), AppendStatus::accepted);
  EXPECT_EQ(again.appended(), 4U);
  solve_until(solver, [&] { return again.wait_until_consumed(Time(0)); });
  EXPECT_NEAR(follow(solver, t + 50ms, 0.4, 1.01), 0.3, 1e-9);
}

}  // namespace
}  // namespace splinecast
