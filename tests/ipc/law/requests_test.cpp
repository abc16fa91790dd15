#include <gtest/gtest.h>

#include <chrono>
#include <optional>

#include "splinecast/rate_commander.hpp"
#include "splinecast/reader.hpp"
#include "splinecast/solver.hpp"
#include "tests/fixtures/processes/process.hpp"
#include "tests/ipc/law/time_law.hpp"

/// Requests of commanders to a law, with simulated time.
namespace splinecast {
namespace {

using std::chrono::milliseconds;
using testing::HostClock;
using testing::TestStream;
using testing::TimeLaw;

TEST_F(TimeLaw, TakesAHoldBeforeWhicheverReadingOfTheClockItsSolverIsDelayed) {
  State state(1);
  for (int reading = 1; reading <= 30; ++reading) {
    operator_.set_rate(1, milliseconds(1));
    pass(milliseconds(100));
    ASSERT_TRUE(has_values(reader_->sample(clock_.now(), state)));
    ASSERT_EQ(reader_->rate().rate, 1) << reading;
    operator_.hold(milliseconds(1));
    clock_.pause_before(reading, milliseconds(30));
    pass(milliseconds(100));
    ASSERT_TRUE(has_values(reader_->sample(clock_.now(), state)));
    ASSERT_EQ(reader_->rate().rate, 0) << reading;
  }
}

TEST(ALaw, BeginsBeforeWhicheverReadingOfTheClockItsSolverIsDelayed) {
  for (int reading = 1; reading <= 30; ++reading) {
    const TestStream law;
    HostClock clock;
    RateCommander commander(law.name(), "operator");
    commander.set_rate(1, milliseconds(1));
    Solver solver(law.name(), {});
    ASSERT_TRUE(solver.attach(clock));
    clock.pause_before(reading, milliseconds(100));
    for (int i = 0; i < 300; ++i) {
      clock.advance(milliseconds(1));
      (void)solver.step(clock);
    }
    Reader reader(law.name());
    State state(1);
    const SampleStatus status = reader.preview(clock.now(), state);
    ASSERT_TRUE(has_values(status)) << to_string(status) << ", delayed before reading " << reading;
    ASSERT_NEAR(state.velocity()[0], 1, 1e-9) << reading;
  }
}

TEST_F(TimeLaw, ASlowRequestInARiseDoesNotRaiseTheRateFurther) {
  operator_.set_rate(0.3, milliseconds(10));
  pass(milliseconds(100));
  operator_.set_rate(0.5, milliseconds(1000));
  pass(milliseconds(505));
  operator_.set_rate(0.2, milliseconds(60'000));
  watch(milliseconds(8000),
        [&](const State&, SampleStatus) { ASSERT_LE(reader_->rate().rate, 0.5 + 1e-6); });
}

TEST_F(TimeLaw, AFasterStopToTheSameRateIsTaken) {
  operator_.set_rate(0, milliseconds(60'000));
  pass(milliseconds(1000));
  RateCommander estop(law_.name(), "estop");
  estop.hold(milliseconds(100));
  pass(milliseconds(200));
  State state(1);
  ASSERT_TRUE(has_values(reader_->sample(clock_.now(), state)));
  EXPECT_EQ(reader_->rate().rate, 0);
}

TEST_F(TimeLaw, AHoldHasItsOwnRampAlsoAfterATakeoverAndBesideOtherRequests) {
  operator_.set_rate(1, milliseconds(60'000));
  RateCommander estop(law_.name(), "estop");
  pass(milliseconds(100));
  law_solver_.reset();
  estop.hold(milliseconds(100));
  operator_.renew();
  pass(milliseconds(100));
  law_solver_.emplace(law_.name(), SolverOptions{});
  ASSERT_TRUE(law_solver_->attach(clock_));
  pass(milliseconds(200));
  State state(1);
  ASSERT_TRUE(has_values(reader_->sample(clock_.now(), state)));
  EXPECT_EQ(reader_->rate().rate, 0);
}

TEST_F(TimeLaw, ATakeoverInARampContinuesItAndTakesAHold) {
  operator_.set_rate(0.2, milliseconds(500));
  pass(milliseconds(200));
  State state(1);
  ASSERT_TRUE(has_values(reader_->sample(clock_.now(), state)));
  const double rate = reader_->rate().rate;
  ASSERT_GT(rate, 0.3);
  ASSERT_LT(rate, 0.9);
  law_solver_.reset();
  law_solver_.emplace(law_.name(), SolverOptions{});
  ASSERT_TRUE(law_solver_->attach(clock_));
  RateCommander estop(law_.name(), "estop");
  estop.hold(milliseconds(50));
  double before = rate;
  watch(milliseconds(150), [&](const State&, SampleStatus) {
    ASSERT_LE(reader_->rate().rate, before + 1e-9);
    before = reader_->rate().rate;
  });
  EXPECT_EQ(before, 0);
}

TEST_F(TimeLaw, ARenewalByANewProcessRenewsTheHoldOfItsPredecessor) {
  std::optional<RateCommander> estop(std::in_place, law_.name(), "estop");
  estop->hold(milliseconds(10));
  pass(milliseconds(100));
  estop.reset();
  estop.emplace(law_.name(), "estop");
  estop->renew();
  pass(milliseconds(100));
  State state(1);
  ASSERT_TRUE(has_values(reader_->sample(clock_.now(), state)));
  EXPECT_EQ(reader_->rate().rate, 0);
}

TEST_F(TimeLaw, ARenewalDoesNotBeginTheRampAgain) {
  State state(1);
  for (const double requested : {0.25, 1.0}) {
    operator_.set_rate(requested, milliseconds(400));
    for (int i = 0; i < 10; ++i) {
      pass(milliseconds(50));
      operator_.renew();
    }
    ASSERT_TRUE(has_values(reader_->sample(clock_.now(), state)));
    EXPECT_EQ(reader_->rate().rate, requested);
  }
}

}  // namespace
}  // namespace splinecast
