#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <algorithm>
#include <string>
#include <vector>

#include "core/online/sliding_window.hpp"
#include "splinecast/fit.hpp"
#include "tests/fixtures/curves/method_trial.hpp"
#include "tests/fixtures/curves/online.hpp"
#include "tests/fixtures/curves/streaming_methods.hpp"

// Every method gives the same curve in the sliding window as in the batch.
namespace splinecast::core {
namespace {

using testing::plain_options;
using testing::random_trial;
using testing::Trial;

class StreamingMethods : public ::testing::TestWithParam<const Method*> {
 protected:
  [[nodiscard]] static const Method& method() { return *GetParam(); }
  [[nodiscard]] static WindowOptions options() { return testing::plain_window(method()); }
};

std::vector<Condition> online_conditions() {
  return {{ConditionKind::own, {}},           {ConditionKind::natural, {}},
          {ConditionKind::clamped, {}},       {ConditionKind::halt, {}},
          {ConditionKind::velocity, {1, -2}}, {ConditionKind::acceleration, {3, 0.5}}};
}

TEST_P(StreamingMethods, GiveTheBitsOfTheBatchWithTheSameConditionsIfTheyAreLocal) {
  if (method().converges()) GTEST_SKIP() << method().name << " only converges to the batch";
  for (const Condition& start : online_conditions()) {
    for (const Condition& end : online_conditions()) {
      for (std::size_t knots = 1; knots < 30; ++knots) {
        for (const std::size_t more : {0U, 3U}) {
          const Trial trial = random_trial(knots, knots, 2, 10);
          FitOptions at_once = plain_options(method());
          at_once.start = start;
          at_once.end = end;
          WindowOptions how = options();
          how.settle += more;
          how.start = start;
          const auto online = testing::online(trial.waypoints(), how, end);
          const auto batch = fit(trial.waypoints(), at_once);
          ASSERT_EQ(online.segments(), batch.segments());
          for (std::size_t i = 0; i < batch.segments(); ++i) {
            ASSERT_EQ(online.order_of(i), batch.order_of(i));
            ASSERT_TRUE(std::ranges::equal(online.coefficients(i), batch.coefficients(i)))
                << to_string(start) << " to " << to_string(end) << ", " << knots
                << " knots, segment " << i;
          }
        }
      }
    }
  }
}

TEST_P(StreamingMethods, SettleAfterAsManyKnotsAsTheyLookAhead) {
  const Trial trial = random_trial(5, 30, 2, 4);
  SlidingWindow window(2, options());
  for (std::size_t n = 0; n < 30; ++n) {
    window.append(trial.waypoints()[n]);
    const std::size_t before = default_settle(method()) + 1;
    EXPECT_EQ(window.settled_segments(), n + 1 > before ? n + 1 - before : 0);
  }
}

TEST_P(StreamingMethods, ChangeNoSettledSegmentAndNeverStepInPositionOrVelocity) {
  EXPECT_TRUE(rc::check("settled", [](std::uint64_t seed) {
    const Trial trial = random_trial(seed, 2 + seed % 90, 2, 6);
    const auto all = trial.waypoints();
    const auto settled = testing::settled_segments(all, options(), {ConditionKind::halt, {}});
    SlidingWindow window(2, options());
    Segment segment(2);
    for (std::size_t n = 0; n < all.size(); ++n) {
      window.append(all[n]);
      for (std::size_t i = window.oldest_segment(); i < window.settled_segments(); ++i) {
        window.segment(i, segment);
        RC_ASSERT(segment.coefficients == settled[i].coefficients);
      }
    }
    double speed = 0;
    for (std::size_t i = 0; i + 1 < all.size(); ++i) {
      const double h = to_seconds(all.times[i + 1] - all.times[i]);
      speed = std::max(speed, std::abs(all[i + 1].position[0] - all[i].position[0]) / h);
    }
    State before(2);
    for (std::size_t i = 1; i < settled.size(); ++i) {
      const Segment& left = settled[i - 1];
      evaluate(left.order, left.coefficients, to_seconds(left.right - left.left), before.ref());
      for (std::size_t d = 0; d < 2; ++d) {
        RC_ASSERT(std::abs(before.position()[d] - settled[i].coefficients[d]) < 1e-11);
        RC_ASSERT(std::abs(before.velocity()[d] - settled[i].coefficients[2 + d]) <
                  1e-11 * (1 + speed));
      }
    }
  }));
}

TEST_P(StreamingMethods, ContinueBitForBitInARestoredWindow) {
  const Trial trial = random_trial(10, 100, 2, 4);
  const auto all = trial.waypoints();
  for (const std::size_t cut : {1U, 2U, 3U, 4U, 5U, 6U, 12U, 40U, 63U, 64U, 65U, 66U, 67U, 80U}) {
    SlidingWindow whole(2, options());
    for (std::size_t n = 0; n < cut; ++n) whole.append(all[n]);
    SlidingWindow resumed(2, options());
    const std::size_t first = cut - std::min(cut, whole.knots_to_restore());
    std::vector<Knot> knots;
    for (std::size_t i = first; i < cut; ++i) knots.push_back(whole.knot(i));
    resumed.restore(first, knots);
    Segment a(2);
    Segment b(2);
    const auto expect_same = [&] {
      for (std::size_t i = whole.oldest_segment(); i < whole.segments(); ++i) {
        whole.segment(i, a);
        resumed.segment(i, b);
        ASSERT_EQ(a.coefficients, b.coefficients) << "cut " << cut << ", segment " << i;
        ASSERT_EQ(a.acceleration_step, b.acceleration_step);
      }
    };
    for (std::size_t n = cut; n < all.size(); ++n) {
      whole.append(all[n]);
      resumed.append(all[n]);
      expect_same();
    }
    whole.finish({ConditionKind::own, {}});
    resumed.finish({ConditionKind::own, {}});
    expect_same();
  }
}

TEST_P(StreamingMethods, RefuseALagShorterThanTheirLookAhead) {
  if (method().converges()) GTEST_SKIP() << method().name << " has no least lag";
  WindowOptions how = options();
  how.settle = method().look_ahead - 1;
  EXPECT_THROW(SlidingWindow(2, how), std::invalid_argument);
}

INSTANTIATE_TEST_SUITE_P(Every, StreamingMethods, ::testing::ValuesIn(testing::streaming_methods()),
                         [](const auto& tested) { return std::string(tested.param->name); });

TEST(SlidingWindow, RefusesMethodsAndConditionsThatNeedAllWaypointsAtOnce) {
  EXPECT_THROW(SlidingWindow(1, {.interpolant = {.method = find_method("normalized")}}),
               std::invalid_argument);
  for (const ConditionKind kind : {ConditionKind::not_a_knot, ConditionKind::periodic}) {
    EXPECT_THROW(SlidingWindow(1, {.start = {kind, {}}}), std::invalid_argument);
  }
}

TEST(SlidingWindow, TakesOnlyWaypointsWithTheDerivativesThatTheMethodNeeds) {
  const double x = 1;
  const std::span<const double> one(&x, 1);
  const Waypoint bare{.time = {}, .position = one};
  const Waypoint moving{.time = {}, .position = one, .velocity = one};
  const Waypoint whole{.time = {}, .position = one, .velocity = one, .acceleration = one};
  const auto takes = [](const char* name, const Waypoint& waypoint) {
    return SlidingWindow(1, {.interpolant = {.method = find_method(name)}}).takes(waypoint);
  };
  EXPECT_TRUE(takes("c2", bare));
  EXPECT_FALSE(takes("hermite", bare));
  EXPECT_TRUE(takes("hermite", moving));
  EXPECT_FALSE(takes("quintic", moving));
  EXPECT_TRUE(takes("quintic", whole));
}

}  // namespace
}  // namespace splinecast::core
