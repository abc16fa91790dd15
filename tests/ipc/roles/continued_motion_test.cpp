#include "ipc/owned/continued_motion.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <vector>

#include "ipc/roles/internals.hpp"
#include "splinecast/producer.hpp"
#include "splinecast/reader.hpp"
#include "splinecast/solver.hpp"
#include "tests/fixtures/processes/process.hpp"
#include "tests/fixtures/streams/memory_stream.hpp"

/// A producer dies and another one continues its ring while the motion lasts. Uses real regions and
/// a clock that the test sets.
namespace splinecast::ipc {
namespace {

using std::chrono::milliseconds;

constexpr double kVelocity = 3;
constexpr double kAcceleration = 15;

class ContinuedRing : public ::testing::Test {
 protected:
  explicit ContinuedRing(bool has_limits = true) {
    clock_.time = std::chrono::seconds(10);
    if (has_limits) {
      how_.limits = MotionLimits{.velocity = {kVelocity}, .acceleration = {kAcceleration}};
    }
    solver_.emplace(stream_.name(), how_);
    start_producer();
    EXPECT_TRUE(solver_->attach(clock_));
    reader_.emplace(stream_.name());
  }

  void start_producer() {
    producer_.reset();
    producer_.emplace(
        Internals::producer(stream_.name(), {.dimensions = 1, .horizon = Time::max()}, clock_));
  }
  AppendStatus append(Time t, double x) {
    return producer_->append({.time = t, .position = {&x, 1}});
  }
  /// A motion within the limits: velocity up to 1.5, acceleration up to 4.5.
  [[nodiscard]] double motion(Time t) const { return 0.5 * std::sin(3 * to_seconds(t)); }
  /// Sends the motion for `length`, 20 ms apart, from 100 ms after now or `from` on.
  Time send_motion(Time length, std::optional<Time> from = {}) {
    Time t = from.value_or(clock_.time + milliseconds(100));
    for (const Time end = t + length; t < end; t += milliseconds(20)) {
      EXPECT_EQ(append(t, motion(t)), AppendStatus::accepted);
      (void)solver_->step(clock_);
    }
    return t;
  }
  /// Lets time pass, and compares what a controller at 1 kHz gets with the limits.
  void pass(Time time) {
    State state(1);
    for (const Time end = clock_.time + time; clock_.time < end; clock_.time += milliseconds(1)) {
      (void)solver_->step(clock_);
      if (!has_values(reader_->sample(clock_.time, state))) continue;
      velocity_ = std::max(velocity_, std::abs(state.velocity()[0]));
      acceleration_ = std::max(acceleration_, std::abs(state.acceleration()[0]));
      if (last_) step_ = std::max(step_, std::abs(state.position()[0] - *last_));
      last_ = state.position()[0];
    }
  }
  void expect_within_limits() {
    EXPECT_LE(velocity_, kVelocity * (1 + 1e-9));
    EXPECT_LE(acceleration_, kAcceleration * (1 + 1e-9));
    EXPECT_LE(step_, kVelocity * 0.001 * (1 + 1e-9));
  }
  [[nodiscard]] const Summary& summary() const { return Internals::summary(*solver_); }

  testing::TestStream stream_;
  testing::FixedClock clock_;
  SolverOptions how_;
  std::optional<Solver> solver_;
  std::optional<Producer> producer_;
  std::optional<Reader> reader_;
  double velocity_ = 0;
  double acceleration_ = 0;
  double step_ = 0;
  std::optional<double> last_{};
};

TEST_F(ContinuedRing, KeepsTheLimitsIfANewProducerBeginsElsewhere) {
  for (const int margin : {8, 30, 150, 200}) {  // ms
    send_motion(milliseconds(400));
    pass(milliseconds(250));
    start_producer();
    ASSERT_TRUE(producer_->continues());
    const std::uint64_t items = producer_->appended();
    const Time first = clock_.time + milliseconds(margin);
    ASSERT_EQ(append(first, motion(first) + 0.7), AppendStatus::accepted) << margin;
    EXPECT_EQ(producer_->appended(), items + 2) << margin;
    for (Time t = first + milliseconds(20); t < first + milliseconds(300); t += milliseconds(20)) {
      ASSERT_EQ(append(t, motion(t) + 0.7), AppendStatus::accepted);
    }
    pass(milliseconds(1500));
    EXPECT_EQ(summary().exceeding, 0U) << margin;
    start_producer();
  }
  expect_within_limits();
  EXPECT_EQ(summary().refused, 0U);
}

TEST_F(ContinuedRing, IsContinuedByTheNextWaypointOfTheSameMotion) {
  const Time next = send_motion(milliseconds(400));
  pass(milliseconds(250));
  const std::uint64_t passed_at_start = summary().passed_over;  // it starts in motion
  start_producer();
  const std::uint64_t items = producer_->appended();
  ASSERT_EQ(append(next, motion(next)), AppendStatus::accepted);
  EXPECT_EQ(producer_->appended(), items + 1);
  send_motion(milliseconds(400), next + milliseconds(20));
  pass(milliseconds(1200));
  expect_within_limits();
  EXPECT_EQ(summary().controls, 0U);
  EXPECT_EQ(summary().passed_over, passed_at_start);
}

TEST_F(ContinuedRing, RefusesAFirstWaypointBeforeTheEarliestTime) {
  send_motion(milliseconds(400));
  pass(milliseconds(250));
  start_producer();
  const std::uint64_t items = producer_->appended();
  EXPECT_EQ(append(clock_.time + milliseconds(2), 0.9), AppendStatus::past);
  EXPECT_EQ(append(clock_.time + milliseconds(2), std::nan("")), AppendStatus::not_finite);
  EXPECT_EQ(producer_->appended(), items);
  const Time later = clock_.time + milliseconds(40);  // before the newest waypoint
  ASSERT_LT(later, producer_->last_time());
  EXPECT_EQ(append(later, 0.9), AppendStatus::accepted);
  EXPECT_EQ(append(later, 0.9), AppendStatus::duplicate) << "the next one is an ordinary append";
}

TEST_F(ContinuedRing, IsReplacedOnlyByTheFirstWaypoint) {
  send_motion(milliseconds(400));
  pass(milliseconds(100));
  start_producer();
  ASSERT_EQ(append(clock_.time + milliseconds(50), 0.6), AppendStatus::accepted);
  const std::uint64_t items = producer_->appended();
  ASSERT_EQ(append(clock_.time + milliseconds(55), -0.6), AppendStatus::accepted);
  EXPECT_EQ(producer_->appended(), items + 1) << "the user's own jump";
}

/// After the settled time and the freeze-ahead come the solver's pauses, 0.2 ms at least.
TEST_F(ContinuedRing, SaysHowEarlyAReplacementIsInTime) {
  constexpr Time kFreeze = milliseconds(5);
  send_motion(milliseconds(400));
  pass(milliseconds(50));
  EXPECT_GE(producer_->earliest(), clock_.time + kFreeze + std::chrono::microseconds(200));
  EXPECT_LE(producer_->earliest(), clock_.time + kFreeze + milliseconds(4));
  clock_.time += milliseconds(40);
  (void)append(producer_->last_time() + milliseconds(20), 0);
  (void)solver_->step(clock_);
  EXPECT_GE(producer_->earliest(), clock_.time + kFreeze + milliseconds(37));
  EXPECT_LE(producer_->earliest(), clock_.time + kFreeze + milliseconds(43));
  pass(milliseconds(2500));
  EXPECT_LE(producer_->earliest(), clock_.time + kFreeze + milliseconds(4)) << "at rest, later";
}

class ContinuedRingWithoutLimits : public ContinuedRing {
 protected:
  ContinuedRingWithoutLimits() : ContinuedRing(false) {}
};

TEST_F(ContinuedRingWithoutLimits, IsReplacedByAWaypointThatIsFasterThanTheMotion) {
  const Time next = send_motion(milliseconds(1500));
  pass(milliseconds(1000));
  start_producer();
  const std::uint64_t items = producer_->appended();
  ASSERT_EQ(append(next, motion(next) + 0.5), AppendStatus::accepted);
  EXPECT_EQ(producer_->appended(), items + 2);
  pass(milliseconds(1500));
  EXPECT_LT(acceleration_, 100) << "a spline through that waypoint has several hundred";
  EXPECT_EQ(summary().controls, 1U);
}

}  // namespace
}  // namespace splinecast::ipc
