#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <random>

#include "ipc/roles/inspect.hpp"
#include "splinecast/snapshot.hpp"
#include "splinecast/stopper.hpp"
#include "tests/ipc/law/held_streams.hpp"

/// Replacements of streams that their time law holds, in simulated time.
namespace splinecast {
namespace {

using std::chrono::milliseconds;
using testing::HeldStreams;
using testing::RecordedArm;

/// How far a stream can move in the nanosecond after the held time.
constexpr double kNanosecond = 5e-9;

std::size_t corners(const RecordedArm& arm) {
  return static_cast<std::size_t>(
      std::ranges::count_if(arm.segments(), &ipc::SegmentCopy::is_corner));
}

TEST_F(HeldStreams, StayWhereTheyRestAfterAStop) {
  hold(milliseconds(100));
  pass(milliseconds(120));
  const double held = arm().x();
  const double other = arm(1).x();
  arm().stop();
  pass(milliseconds(5));
  ASSERT_TRUE(arm().begins_from_rest());
  EXPECT_EQ(arm().producer().replacement_begin()->begin, stream_now() + Time(1));
  EXPECT_EQ(arm().x(), held);
  go(milliseconds(100));
  for (int i = 0; i < 500; ++i) {
    pass(milliseconds(1));
    ASSERT_NEAR(arm().x(), held, kNanosecond);
  }
  EXPECT_GT(std::abs(arm(1).x() - other), 0.1);
  arm().resume(stream_now() + milliseconds(300));
  double farthest = 0;
  for (int i = 0; i < 1000; ++i) {
    pass(milliseconds(1));
    farthest = std::max(farthest, std::abs(arm().x() - held));
  }
  EXPECT_GT(farthest, 0.1);
  for (const std::size_t i : {0U, 1U}) {
    const auto found = arm(i).verify();
    EXPECT_FALSE(found.first) << found.first->what;
    EXPECT_GT(found.equal, 20U);
    EXPECT_EQ(corners(arm(i)), i == 0 ? 1U : 0U);
  }
}

TEST_F(HeldStreams, StayWhereTheyRestAfterTheStopOfAStopper) {
  hold(milliseconds(100));
  pass(milliseconds(120));
  const double held = arm().x();
  Stopper stopper(arm().name(), "panel");
  const auto number = stopper.stop();
  arm().starve();
  pass(milliseconds(10));
  EXPECT_TRUE(stopper.wait_in_force(number, Time::zero()));
  go(milliseconds(100));
  for (int i = 0; i < 500; ++i) {
    pass(milliseconds(1));
    ASSERT_NEAR(arm().x(), held, kNanosecond);
  }
  const auto released = stopper.release();
  pass(milliseconds(10));
  EXPECT_TRUE(stopper.wait_in_force(released, Time::zero()));
  arm().resume(stream_now() + milliseconds(300));
  double farthest = 0;
  for (int i = 0; i < 1000; ++i) {
    pass(milliseconds(1));
    farthest = std::max(farthest, std::abs(arm().x() - held));
  }
  EXPECT_GT(farthest, 0.1);
  const auto found = arm().verify();
  EXPECT_FALSE(found.first) << found.first->what;
  EXPECT_GT(found.equal, 20U);
  EXPECT_EQ(corners(arm()), 1U);
}

TEST_F(HeldStreams, BeginARedirectAtRest) {
  hold(milliseconds(50));
  pass(milliseconds(70));
  const double held = arm().x();
  const double v = std::cos(std::asin(held)) * 4;
  ASSERT_GT(v, 0.1);
  arm().redirect(arm().x() > 0 ? 3.0 : 0.5);
  pass(milliseconds(5));
  ASSERT_TRUE(arm().begins_from_rest());
  go(milliseconds(50));
  pass(milliseconds(1));
  // The entry leads from rest: nothing of the old velocity is left.
  for (int i = 0; i < 20; ++i) {
    pass(milliseconds(1));
    ASSERT_LT(std::abs(arm().x() - held), 0.02) << i;
  }
  pass(milliseconds(1500));
  const auto found = arm().verify();
  EXPECT_FALSE(found.first) << found.first->what;
  EXPECT_EQ(corners(arm()), 1U);
}

TEST_F(HeldStreams, KeepThePathUntilALaterReplacement) {
  hold(milliseconds(50));
  pass(milliseconds(70));
  const Time held = stream_now();
  arm().redirect(1.0, milliseconds(100));
  pass(milliseconds(5));
  ASSERT_TRUE(arm().producer().replacement_begin());
  EXPECT_FALSE(arm().begins_from_rest());
  EXPECT_GE(arm().producer().replacement_begin()->begin, held + milliseconds(100));
}

TEST_F(HeldStreams, EndAStopThatTheHoldInterrupts) {
  arm().stop();
  pass(milliseconds(20));
  EXPECT_FALSE(arm().begins_from_rest());
  hold(milliseconds(20));
  pass(milliseconds(40));
  const double held = arm().x();
  EXPECT_TRUE(arm().begins_from_rest());
  go(milliseconds(20));
  for (int i = 0; i < 500; ++i) {
    pass(milliseconds(1));
    ASSERT_NEAR(arm().x(), held, kNanosecond);
  }
  const auto found = arm().verify();
  EXPECT_FALSE(found.first) << found.first->what;
  EXPECT_EQ(corners(arm()), 1U);
}

TEST_F(HeldStreams, ContinueAfterAHoldInAStopByStarvation) {
  arm().starve();
  State state(1);
  while (arm().reader().sample(clock_.now(), state) != SampleStatus::stopping) {
    pass(milliseconds(1));
  }
  pass(milliseconds(30));
  hold(milliseconds(10));
  pass(milliseconds(30));
  const double held = arm().x();
  go(milliseconds(10));
  pass(milliseconds(100));
  EXPECT_GT(std::abs(arm().x() - held), 1e-3);
  EXPECT_EQ(corners(arm()), 0U);
}

TEST_F(HeldStreams, StopAsWithoutAHoldWhileTheLawHasNoSolver) {
  hold(milliseconds(20));
  pass(milliseconds(40));
  law_solver_.reset();
  pass(milliseconds(20));
  arm().stop();
  pass(milliseconds(5));
  ASSERT_TRUE(arm().producer().replacement_begin());
  EXPECT_FALSE(arm().begins_from_rest());
  // The next solver of the law knows that it holds: then the stop ends here, too.
  start_law();
  pass(milliseconds(20));
  EXPECT_TRUE(arm().begins_from_rest());
  const double held = arm().x();
  go(milliseconds(20));
  pass(milliseconds(500));
  EXPECT_NEAR(arm().x(), held, kNanosecond);
  const auto found = arm().verify();
  EXPECT_FALSE(found.first) << found.first->what;
}

TEST_F(HeldStreams, HaveNoSegmentAsSettledThatAStopCanReplace) {
  hold(milliseconds(100));
  pass(milliseconds(120));
  const Time held = stream_now();
  Snapshot curve(1);
  // The word on the board promises more than the law has reached.
  EXPECT_GT(ipc::Internals::sampler(arm().reader()).settled_until(), held + Time(1));
  EXPECT_EQ(arm().reader().settled_until(), held + Time(1));
  EXPECT_EQ(arm().reader().progress()->settled_until, held + Time(1));
  EXPECT_EQ(ipc::inspect(arm().name()).summary.settled_until, held + Time(1));
  EXPECT_EQ(arm().reader().snapshot(held, held + Time(1), curve), SampleStatus::provisional);
  EXPECT_EQ(curve.settled_until(), held + Time(1));
  EXPECT_EQ(arm().reader().snapshot(held - milliseconds(10), held, curve), SampleStatus::settled);
  EXPECT_LE(arm().segments().back().right, held + Time(1));
  arm().stop();
  pass(milliseconds(10));
  EXPECT_EQ(arm().segments().back().right, held + Time(1));
  ASSERT_TRUE(has_values(arm().reader().snapshot(held, held + milliseconds(1), curve)));
  EXPECT_TRUE(curve[1].is_corner);
  EXPECT_EQ(curve[1].left, held + Time(1));
}

TEST_F(HeldStreams, PreviewThatAReplacementBeginsAtRest) {
  EXPECT_FALSE(arm().producer().preview_replace(Time::min(), {}).from_rest);
  hold(milliseconds(100));
  pass(milliseconds(120));
  const Time held = stream_now();
  ReplacePreview preview;
  // The producer reads the time of the host, which the simulated one overtakes until here.
  EXPECT_TRUE(testing::await([&] {
    clock_.advance(std::max(MonotonicClock().now() - clock_.now(), Time::zero()));
    (void)law_solver_->step(clock_);
    preview = arm().producer().preview_replace(Time::min(), {});
    return preview.from_rest;
  }));
  EXPECT_TRUE(preview.is_known);
  EXPECT_EQ(preview.begin, held + Time(1));
}

/// Random holds with stops, redirects, takeovers and laws without a solver.
class RandomHolds : public HeldStreams {
 protected:
  [[nodiscard]] std::int64_t below(std::int64_t end) {
    return std::uniform_int_distribution<std::int64_t>(0, end - 1)(random_);
  }
  /// From 1 ms to 1 s; once in 50 a minute.
  [[nodiscard]] Time ramp() {
    if (below(50) == 0) return std::chrono::minutes(1);
    const double exponent = std::uniform_real_distribution(0.0, 3.0)(random_);
    return Time(static_cast<std::int64_t>(1e6 * std::pow(10.0, exponent)));
  }
  void disturb() {
    if (below(4) == 0) arm(static_cast<std::size_t>(below(2))).take_over();
    if (below(8) == 0) law_solver_.reset();
  }

  /// Moves, and requests a hold, perhaps after a stop. Returns whether the law then rests.
  bool begin_hold(RecordedArm& moved, bool stops) {
    pass(milliseconds(100 + below(300)));
    if (stops) moved.stop();
    if (stops) pass(milliseconds(below(100)));
    const Time length = ramp();
    hold(length);
    const bool rests = below(4) != 0;
    const Time way = rests ? length * 5 / 4 + milliseconds(20) : Time(below(length.count()));
    pass(way, std::max<Time>(milliseconds(1), length / 500));
    return rests;
  }
  /// Releases the hold. A stopped stream does not move.
  void end_hold(RecordedArm& moved, bool is_stopped) {
    const bool stays = is_stopped && rate() == 0;
    const double rest = moved.x();
    go(ramp() % std::chrono::seconds(1) + milliseconds(1));
    for (int i = 0; i < 100; ++i) {
      pass(milliseconds(1));
      if (stays) {
        ASSERT_NEAR(moved.x(), rest, kNanosecond);
      }
    }
    if (moved.begins_from_rest()) ++corners_;
    moved.resume(std::max(stream_now(), moved.producer().last_time()) + milliseconds(300));
    pass(milliseconds(800));
  }

  void play() {
    RecordedArm& moved = arm(static_cast<std::size_t>(below(2)));
    const bool stops_before = below(4) == 0;
    const bool rests = begin_hold(moved, stops_before);
    disturb();
    pass(milliseconds(below(10)));
    const bool is_held = rests && law_solver_.has_value();
    const double held = moved.x();
    const std::int64_t action = stops_before ? 2 : below(3);
    if (action == 0) moved.stop();
    if (action == 1) moved.redirect(static_cast<double>(below(6)), milliseconds(below(15)));
    pass(milliseconds(2 + below(10)));
    if (action < 2 && is_held) {
      EXPECT_TRUE(moved.begins_from_rest());
    }
    disturb();
    if (!law_solver_) start_law();
    pass(milliseconds(5 + below(10)));
    if (rests) {
      EXPECT_EQ(moved.x(), held);
    }
    end_hold(moved, action == 0 || stops_before);
  }

  std::mt19937_64 random_{1};
  std::size_t corners_ = 0;
};

TEST_F(RandomHolds, KeepWhatIsPromisedAndAreVerifiedToTheBit) {
  const char* const cases = std::getenv("SPLINECAST_HOLDS");
  const std::size_t count = cases != nullptr ? std::stoul(cases) : 100;
  for (std::size_t i = 0; i < count && !HasFailure(); ++i) play();
  EXPECT_GT(corners_, count / 4);
  for (const std::size_t i : {0U, 1U}) {
    const auto found = arm(i).verify();
    EXPECT_FALSE(found.first) << found.first->what << ": " << found.first->published << ", "
                              << found.first->solved;
    EXPECT_GT(found.equal, 10 * count);
  }
}

}  // namespace
}  // namespace splinecast
