#include "splinecast/core/limits.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "splinecast/core/splice.hpp"

namespace splinecast::core {
namespace {

/// Largest absolute acceleration at many times of a segment.
double sampled_peak(const Segment& segment, std::size_t dimensions, std::size_t d) {
  State state(dimensions);
  const double h = to_seconds(segment.right - segment.left);
  double peak = 0;
  for (int i = 0; i <= 1000; ++i) {
    evaluate(segment.order, segment.coefficients, h * i / 1000, state.ref());
    peak = std::max(peak, std::abs(state.acceleration()[d]));
  }
  return peak;
}

TEST(Limits, AStopTailKeepsItsLimitOrWhatItBeginsWithAndTakesNoLongerThanItMust) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> value(-10, 10);
  for (int i = 0; i < 500; ++i) {
    const std::vector<double> x{0};
    const std::vector<double> v{value(random)};
    const std::vector<double> a{i % 5 == 0 ? 0 : value(random)};
    const std::vector<double> limit{1 + std::abs(value(random))};
    const Time time = stop_time_within(limit, kLeastStopTime, v, a);
    Segment tail(1);
    build_stop_tail(Time(0), time, x, v, a, tail);
    const double allowed = std::max(limit[0], std::abs(a[0]));
    EXPECT_LE(sampled_peak(tail, 1, 0), allowed * (1 + 1e-6));
    EXPECT_NEAR(peak_acceleration(tail, 1, 0), sampled_peak(tail, 1, 0), 1e-4 * allowed);
    if (a[0] == 0) {
      EXPECT_NEAR(to_seconds(time), std::max(1.5 * std::abs(v[0]) / limit[0], 1e-3), 2e-9);
    }
  }
}

TEST(Limits, AMoveFromRestToRestPeaksAtItsLimit) {
  const std::vector<double> limits{3, 0, 5};
  const std::vector<double> distance{0.2, 100, -1};
  const Time time = move_time_within(limits, kLeastStopTime, distance);
  const std::vector<double> zeros(3);
  Segment move(3);
  build_splice({Time(0), zeros, zeros, zeros}, {time, distance, zeros, zeros}, move);
  EXPECT_NEAR(peak_acceleration(move, 3, 2), 5, 1e-6);
  EXPECT_LT(peak_acceleration(move, 3, 0), 3);
  EXPECT_TRUE(keeps_within(limits, move));
  EXPECT_NEAR(acceleration_excess(limits, move), 1, 1e-6);
  EXPECT_FALSE(keeps_within(std::vector<double>{3, 0, 4.9}, move));
}

TEST(Limits, WhatASegmentBeginsWithMayBeBeyondThem) {
  const std::vector<double> x{0};
  const std::vector<double> v{0};
  const std::vector<double> a{8};
  Segment tail(1);
  build_stop_tail(Time(0), Time(1'000'000'000), x, v, a, tail);
  EXPECT_TRUE(keeps_within(std::vector<double>{1}, tail));
  EXPECT_NEAR(acceleration_excess(std::vector<double>{1}, tail), 8, 1e-12);
}

}  // namespace
}  // namespace splinecast::core
