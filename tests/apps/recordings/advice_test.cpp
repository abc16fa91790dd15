#include "apps/recordings/advice.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <random>

#include "apps/process/exit_codes.hpp"
#include "splinecast/waypoint.hpp"

namespace splinecast::apps {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::seconds;

/// A table of one dimension: the values of a function of seconds at these times.
template <typename Function>
WaypointTable table_of(const std::vector<Time>& times, const Function& x) {
  WaypointTable table;
  table.file = "a.csv";
  table.names = {"x"};
  for (const Time t : times) {
    table.times.push_back(t);
    table.lines.push_back(table.lines.size() + 2);
    table.positions.push_back(x(to_seconds(t)));
  }
  return table;
}

std::vector<Time> steady(Time interval, std::size_t rows) {
  std::vector<Time> times;
  for (std::size_t i = 0; i < rows; ++i) times.push_back(static_cast<int>(i) * interval);
  return times;
}

/// 10 s of 0.5 sin(2 t) at 100 Hz, with Gaussian noise of standard deviation sigma.
WaypointTable noisy_sine(double sigma, unsigned seed = 1) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0, 1);
  return table_of(steady(milliseconds(10), 1001),
                  [&](double t) { return 0.5 * std::sin(2 * t) + sigma * noise(random); });
}

DimensionMotion motion_of(const WaypointTable& table) {
  return measure_motion(table, measure_intervals(table.times)).front();
}

TEST(Advice, MeasuresIntervalsJitterAndGaps) {
  std::vector<Time> times{Time(0)};
  for (int i = 1; i <= 100; ++i) {
    times.emplace_back(i * milliseconds(10) + (i % 2 == 1 ? microseconds(500) : microseconds(0)));
  }
  for (int i = 0; i < 3; ++i) times.push_back(times.back() + milliseconds(200 + 100 * i));
  const Intervals found = measure_intervals(times);
  EXPECT_EQ(found.p5, microseconds(9500));
  EXPECT_EQ(found.p95, microseconds(10500));
  EXPECT_EQ(found.largest, milliseconds(400));
  EXPECT_EQ(found.longest_gap, milliseconds(400));
  EXPECT_EQ(found.gaps, 3U);
  EXPECT_EQ(found.median, microseconds(10500));
  EXPECT_EQ(found.jitter, milliseconds(1));
}

TEST(Advice, AnIntervalOfFiveMediansIsNotAGap) {
  const Intervals found =
      measure_intervals(std::vector<Time>{Time(0), Time(10), Time(20), Time(30), Time(80)});
  EXPECT_EQ(found.gaps, 0U);
  EXPECT_EQ(found.longest_gap, Time(0));
  EXPECT_EQ(found.jitter, Time(40));
}

TEST(Advice, FindsTheAddedNoise) {
  for (const double sigma : {1e-4, 1e-3, 1e-2}) {
    for (const unsigned seed : {1U, 2U, 3U}) {
      EXPECT_NEAR(motion_of(noisy_sine(sigma, seed)).noise, sigma, 0.15 * sigma) << seed;
    }
  }
}

TEST(Advice, FindsTheNoiseOfUnevenTimes) {
  for (const unsigned seed : {5U, 6U}) {
    std::mt19937 random(seed);
    std::uniform_int_distribution<int> microsecond(3'000, 20'000);
    std::normal_distribution<double> noise(0, 1e-3);
    std::vector<Time> times{Time(0)};
    while (times.size() < 2000) times.push_back(times.back() + microseconds(microsecond(random)));
    const WaypointTable table =
        table_of(times, [&](double t) { return 2 + 3 * t * t + noise(random); });
    EXPECT_NEAR(motion_of(table).noise, 1e-3, 1.5e-4) << seed;
  }
}

TEST(Advice, AcceptsAnyTimesAndValuesThatAFileCanHave) {
  const Time last = kLatestTime;
  for (const double x : {1e100, 1e-300}) {
    const Advice found = advise(
        table_of({-last, -last + Time(1), Time(0), last}, [&](double t) { return t < 0 ? -x : x; }),
        milliseconds(5), std::nullopt, false);
    EXPECT_GT(found.lead, seconds(1));
    EXPECT_GE(found.silences.back().dry, Time(0));
    EXPECT_TRUE(std::isfinite(found.limits.acceleration.front()));
  }
}

TEST(Advice, FindsTheRoundingOfACoarseEncoder) {
  constexpr double kStep = 0.01;
  const WaypointTable slow = table_of(steady(milliseconds(1), 2001), [](double t) {
    return kStep * std::round(0.1 * std::sin(t) / kStep);
  });
  EXPECT_NEAR(motion_of(slow).noise, kStep / std::sqrt(12), 1e-9);
  EXPECT_EQ(motion_of(table_of(steady(milliseconds(10), 100), [](double) { return 3.0; })).noise,
            0);
}

TEST(Advice, MeasuresTheMotionAndNotItsNoise) {
  for (const double sigma : {0.0, 1e-4}) {
    const DimensionMotion motion = motion_of(noisy_sine(sigma));
    EXPECT_NEAR(motion.peak_velocity, 1, 0.02);
    EXPECT_NEAR(motion.velocity, 0.99, 0.03);
    EXPECT_NEAR(motion.peak_acceleration, 2, 0.35);
    EXPECT_NEAR(motion.acceleration, 1.98, 0.15);
  }
}

TEST(Advice, ExcludesRestFromTheQuantiles) {
  const auto moves_late = [](double t) { return t < 9 ? 0.0 : 0.5 * std::pow(t - 9, 2); };
  const DimensionMotion motion = motion_of(table_of(steady(milliseconds(10), 1001), moves_late));
  EXPECT_NEAR(motion.acceleration, 1, 0.05);
  EXPECT_NEAR(motion.velocity, 0.95, 0.06);
}

TEST(Advice, ComputesNoVelocityAcrossAGap) {
  std::vector<Time> times = steady(milliseconds(10), 100);
  for (const Time t : steady(milliseconds(10), 100)) times.push_back(seconds(3) + t);
  const auto jumps = [](double t) { return t < 2 ? t : 1000 + t; };
  const DimensionMotion motion = motion_of(table_of(times, jumps));
  EXPECT_NEAR(motion.peak_velocity, 1, 1e-9);
  EXPECT_LT(motion.peak_acceleration, 1e-6);
}

TEST(Advice, RefusesRecordingsThatAreTooShort) {
  const auto advise_rows = [](std::size_t rows) {
    return advise(table_of(steady(milliseconds(10), rows), [](double t) { return t; }),
                  milliseconds(5), std::nullopt, false);
  };
  EXPECT_THROW((void)advise_rows(2), InputError);
  EXPECT_THROW((void)advise_rows(10), InputError);
  EXPECT_NO_THROW((void)advise_rows(11));
}

TEST(Advice, TheLeadCoversTheDepthThatKNeedsAndTheJitter) {
  const SolvedHow how{.settle = 8, .settle_ahead = milliseconds(5)};
  EXPECT_EQ(depth_needed(milliseconds(10), how), milliseconds(95));
  const Intervals fast{.median = milliseconds(10), .jitter = milliseconds(2)};
  EXPECT_EQ(advised_lead(fast, Time::max(), how), milliseconds(200));
  const Intervals slow{.median = milliseconds(40), .jitter = microseconds(7200)};
  EXPECT_EQ(advised_lead(slow, Time::max(), how), milliseconds(373));
  EXPECT_EQ(advised_lead(slow, milliseconds(300), how), milliseconds(313));
  EXPECT_EQ(advised_lead({.median = Time::max()}, Time::max(), how), Time::max());
}

TEST(Advice, LowersKIfTheLeadWouldBeLong) {
  const auto settle = [](Time interval) {
    return advised_settle({.median = interval}, milliseconds(5));
  };
  EXPECT_EQ(settle(milliseconds(100)), 8U);
  EXPECT_EQ(settle(milliseconds(150)), 5U);
  EXPECT_EQ(settle(seconds(2)), 4U);
}

TEST(Advice, LimitsAreThreeTimesTheMotionAndTheStopKeepsThem) {
  const std::vector<DimensionMotion> motion{
      {.velocity = 1, .peak_velocity = 1.2, .acceleration = 2, .peak_acceleration = 3},
      {.velocity = 0.1, .peak_velocity = 0.1, .acceleration = 0, .peak_acceleration = 0},
      {}};
  const AdvisedLimits limits = advised_limits(motion);
  EXPECT_EQ(limits.velocity, (std::vector<double>{3, 0.1 * 3, 0}));
  EXPECT_EQ(limits.acceleration, (std::vector<double>{6, 0.1 * 1.5, 0}));
  EXPECT_EQ(limits.stop_length, seconds(1));  // of the second dimension: 1.5 · 0.1 / 0.15
  EXPECT_EQ(advised_limits(std::span(motion).first(1)).stop_length, milliseconds(300));
  EXPECT_EQ(advised_limits(std::span(motion).last(1)).stop_length, milliseconds(250));
}

class Silences : public ::testing::Test {
 protected:
  [[nodiscard]] SilenceEffect foreseen(Time lead, Time silence) const {
    return foresee(lead, silence, milliseconds(10), milliseconds(5), motion_, limits_);
  }
  std::vector<DimensionMotion> motion_{{.velocity = 1, .peak_velocity = 1, .acceleration = 2}};
  AdvisedLimits limits_{.velocity = {3}, .acceleration = {6}, .stop_length = milliseconds(250)};
};

TEST_F(Silences, ThatTheDepthCoversHaveNoEffect) {
  const SilenceEffect found = foreseen(milliseconds(200), milliseconds(100));
  EXPECT_EQ(found.depth_left, milliseconds(90));
  EXPECT_EQ(found.dry, Time(0));
  EXPECT_FALSE(found.comes_to_rest);
  EXPECT_EQ(found.return_time, std::vector<std::optional<double>>{0.0});
}

TEST_F(Silences, LongerThanTheDepthStarveTheStreamWhichReturnsInMinimumTime) {
  const SilenceEffect found = foreseen(milliseconds(60), milliseconds(300));
  EXPECT_EQ(found.dry, milliseconds(255));
  EXPECT_TRUE(found.comes_to_rest);
  // From rest, 0.255 − 0.125 away from a path of velocity 1: accelerates with 6 to a velocity of
  // 1 + u, and then decelerates with 6 to velocity 1.
  const double u = std::sqrt(6 * 0.13 + 0.5);
  EXPECT_NEAR(*found.return_time.front(), (2 * u + 1) / 6, 1e-9);
  EXPECT_FALSE(foreseen(milliseconds(60), milliseconds(100)).comes_to_rest);
}

TEST_F(Silences, AreFollowedByAReturnWithinTheVelocityLimit) {
  limits_.velocity = {1.5};
  const double capped = *foreseen(milliseconds(60), milliseconds(300)).return_time.front();
  // 0.13 away: accelerates from 0 to 1.5, stays 0.5 faster than the path, decelerates to 1.
  const double ramps = (0.25 - 0.5) / 6;
  EXPECT_NEAR(capped, 1.5 / 6 + (0.13 - ramps) / 0.5 + 0.5 / 6, 1e-9);
  limits_.velocity = {0.9};
  EXPECT_FALSE(foreseen(milliseconds(60), milliseconds(300)).return_time.front());
}

}  // namespace
}  // namespace splinecast::apps
