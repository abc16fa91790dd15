#include "ipc/law/follower.hpp"
#include "core/laws/rate_plan.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <deque>
#include <optional>
#include <random>
#include <string>

#include "ipc/law/effect.hpp"
#include "ipc/options/stream.hpp"
#include "splinecast/errors.hpp"
#include "splinecast/producer.hpp"
#include "splinecast/rate_commander.hpp"
#include "splinecast/reader.hpp"
#include "splinecast/solver.hpp"
#include "splinecast/streams.hpp"
#include "tests/fixtures/processes/process.hpp"

namespace splinecast::ipc {
namespace {

using std::chrono::milliseconds;
using testing::TestStream;

/// A law that is solved in simulated time.
class SolvedLaw : public ::testing::Test {
 protected:
  class TestClock final : public Clock {
   public:
    [[nodiscard]] Time now() const noexcept override { return now_; }
    void advance(Time by) { now_ += by; }

   private:
    Time now_ = MonotonicClock().now();
  };

  SolvedLaw() {
    commander_->set_rate(1, milliseconds(100));
    solver_.emplace(law_.name(), SolverOptions{});
    EXPECT_TRUE(solver_->attach(clock_));
    pass(milliseconds(60));
  }

  void pass(Time time) {
    for (const Time end = clock_.now() + time; clock_.now() < end;) {
      clock_.advance(milliseconds(1));
      (void)solver_->step(clock_);
    }
  }

  TestStream law_;
  TestClock clock_;
  std::optional<RateCommander> commander_{std::in_place, law_.name(), "operator"};
  std::optional<Solver> solver_;
};

TEST_F(SolvedLaw, ItsRateIsTheDerivativeOfStreamTime) {
  LawFollower law(law_.name(), {});
  commander_->set_rate(0.25, milliseconds(100));
  LawPoint before;
  LawPoint after;
  for (int i = 0; i < 200; ++i) {
    pass(milliseconds(1));
    // Symmetric differences over 2 µs.
    ASSERT_TRUE(has_values(law.ahead(clock_.now() - Time(1000), before)));
    ASSERT_TRUE(has_values(law.ahead(clock_.now() + Time(1000), after)));
    LawPoint here;
    ASSERT_TRUE(has_values(law.at(clock_.now(), here)));
    const double passed =
        to_seconds(after.stream - before.stream) + (after.fraction - before.fraction);
    EXPECT_NEAR(passed / 2e-6, here.rates.rate, 1e-6);
    EXPECT_GE(here.fraction, 0);
    EXPECT_LE(here.fraction, 1e-9);
    EXPECT_EQ(law.last().stream, here.stream);
    EXPECT_EQ(law.last_host(), clock_.now());
  }
}

TEST_F(SolvedLaw, ItsClockBoundsWhatTheLawWillReach) {
  LawFollower law(law_.name(), {});
  const LawClock stream_clock(law, clock_);
  std::mt19937 random(11);
  std::deque<std::pair<Time, Time>> bounds;  // host time, the latest stream time then
  Time last = stream_clock.now();
  for (int i = 0; i < 4000; ++i) {
    if (i % 40 == 0) {
      commander_->set_rate(std::uniform_int_distribution(0, 4)(random) / 4.0,
                           milliseconds(std::uniform_int_distribution(5, 80)(random)));
    }
    pass(milliseconds(1));
    const Time now = stream_clock.now();
    EXPECT_GE(now, last);
    last = now;
    for (; !bounds.empty() && bounds.front().first <= clock_.now(); bounds.pop_front()) {
      ASSERT_LE(now, bounds.front().second);
    }
    const Time ahead = milliseconds(5);
    const Time latest = stream_clock.latest(now, ahead);
    EXPECT_LE(latest, now + ahead + Time(2)) << "at most the largest rate, 1";
    bounds.emplace_back(clock_.now() + ahead, latest);
  }
}

TEST_F(SolvedLaw, ReportsWhetherItIsHeld) {
  LawFollower law(law_.name(), {});
  const LawClock stream_clock(law, clock_);
  (void)stream_clock.now();
  EXPECT_FALSE(stream_clock.is_held());
  commander_->hold(milliseconds(20));
  pass(milliseconds(100));
  const Time held = stream_clock.now();
  EXPECT_TRUE(stream_clock.is_held());
  pass(milliseconds(1000));
  EXPECT_EQ(stream_clock.now(), held);
}

TEST_F(SolvedLaw, IsFollowedFurtherWhenItIsRemovedButNotItsSuccessor) {
  RegionHeader stream{};
  std::ranges::copy(law_.name(), stream.law.begin());
  LawFollower law(law_.name(), {});
  stream.law_id = law.header().stream_id;
  EXPECT_NO_THROW(LawFollower(stream, {}));
  commander_->set_rate(0.5, milliseconds(10));
  pass(milliseconds(50));
  solver_.reset();
  commander_.reset();
  remove_stream(law_.name());
  EXPECT_TRUE(law.is_lost());
  EXPECT_THROW(LawFollower(stream, {}), NoSuchStream);
  LawPoint first;
  LawPoint later;
  ASSERT_TRUE(has_values(law.at(clock_.now(), first)));
  ASSERT_TRUE(has_values(law.at(clock_.now() + milliseconds(1000), later)));
  EXPECT_NEAR(to_seconds(later.stream - first.stream), 0.5, 1e-8);
  // Another law under the same name.
  commander_.emplace(law_.name(), "operator");
  commander_->set_rate(1, milliseconds(10));
  solver_.emplace(law_.name(), SolverOptions{});
  ASSERT_TRUE(solver_->attach(clock_));
  EXPECT_THROW(LawFollower(stream, {}), NoSuchStream);
  EXPECT_NO_THROW(LawFollower(law_.name(), {}));
}

TEST_F(SolvedLaw, AStreamThatIsNotALawIsNotFollowed) {
  TestStream stream;
  Producer producer(stream.name(), {});
  Solver solver(stream.name(), {});
  ASSERT_TRUE(solver.attach(clock_));
  EXPECT_THROW(LawFollower(stream.name(), {}), BadRegion);
  EXPECT_THROW(LawFollower("none-" + law_.name(), {}), NoSuchStream);
}

TEST_F(SolvedLaw, TheEffectOfARampOnAUniformMotionIsThatOfTheRamp) {
  TestStream arm;
  Producer producer(arm.name(), {.clock = StreamClock::law, .law = law_.name()});
  Solver solver(arm.name(), {});
  ASSERT_TRUE(solver.attach(clock_));
  EXPECT_EQ(followers_of(LawFollower(law_.name(), {}).header().stream_id, {}),
            std::vector<std::string>{arm.name()});
  LawFollower law(law_.name(), {});
  const LawClock stream_clock(law, clock_);
  const Time begin = stream_clock.now() + milliseconds(200);
  constexpr double kSpeed = 3;
  for (int i = 0; i < 400; ++i) {
    const std::array x{kSpeed * 0.02 * i};
    ASSERT_EQ(producer.append({.time = begin + i * milliseconds(20), .position = x}),
              AppendStatus::accepted);
  }
  // The motion from rest onto the line ends.
  for (const Time end = clock_.now() + milliseconds(3000); clock_.now() < end;) {
    pass(milliseconds(1));
    (void)solver.step(clock_);
  }
  const auto from = law.state_at(clock_.now() + milliseconds(10));
  ASSERT_TRUE(from);
  for (const double rate : {0.0, 0.25, 0.75}) {
    const Time length = milliseconds(100);
    const core::RateCurve ramp =
        core::ramp_alone(from->time, {.rate = 1, .slope = 0}, {.rate = rate, .ramp = length});
    const RampEffect effect = effect_of(arm.name(), *from, ramp, Time(law.header().law_origin),
                                        length + milliseconds(200), {});
    const double slope = 1.5 * (1 - rate) / to_seconds(length);
    const double curvature = 4 * slope / to_seconds(length);
    EXPECT_NEAR(effect.velocity[0], kSpeed, 1e-3);
    EXPECT_NEAR(effect.acceleration[0], kSpeed * slope, 1e-2 * kSpeed * slope);
    EXPECT_NEAR(effect.jerk[0], kSpeed * curvature, 1e-2 * kSpeed * curvature);
    EXPECT_LT(effect.worst.ratio, 0) << "there are no limits";
  }
}

TEST(LawPoints, ValuesThatAreNotTimesAreClamped) {
  for (const double value : {1e300, -1e300, 9.3e9, -9.3e9}) {
    const LawPoint point = point_at(value, Time(1), {});
    EXPECT_GE(point.fraction, 0);
    EXPECT_LE(point.fraction, 1e-9);
    EXPECT_EQ(point.stream > Time(1), value > 0) << "a law does not go before its origin";
  }
}

}  // namespace
}  // namespace splinecast::ipc
