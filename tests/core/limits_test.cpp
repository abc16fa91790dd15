#include "splinecast/core/limits.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <random>
#include <vector>

#include "splinecast/core/sliding_window.hpp"
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

/// Whether `run` comes to its end, in a process that is killed after 20 s.
template <typename Run>
void expect_an_end(const Run& run) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(
      {
        alarm(20);
        run();
        std::_Exit(0);
      },
      ::testing::ExitedWithCode(0), "");
}

TEST(Limits, AStopFromAnyVelocityIsFoundInABoundedNumberOfTries) {
  expect_an_end([] {
    constexpr double kTiny = std::numeric_limits<double>::denorm_min();
    const std::array values{0.0,    kTiny,   3 * kTiny, -17 * kTiny, 1e-310,
                            1e-300, -1e-100, 1.0,       1e100,       -1e200};
    for (const double v : values) {
      for (const double a : values) {
        for (const double limit : {kTiny, 1e-310, 1e-100, 1e-3, 4.0, 10.0, 1e100}) {
          const Time time =
              stop_time_within(std::array{limit}, kLeastStopTime, std::array{v}, std::array{a});
          if (time < kLeastStopTime || to_seconds(time) > 1e6) std::_Exit(1);
        }
      }
    }
  });
}

/// Its velocities decay by 0.27 a knot until they are denormal.
TEST(Limits, AWindowGoesOnThroughOnePositionRepeated) {
  for (const Tail tail : {Tail::natural, Tail::parabolic, Tail::bessel}) {
    expect_an_end([tail] {
      WindowOptions options{.tail = tail, .limits = {.acceleration = {10}}};
      SlidingWindow window(1, options);
      Segment last(1);
      for (int i = 0; i < 2000; ++i) {
        const double x = i < 20 ? std::sin(i) : 0;
        window.append({.time = std::chrono::milliseconds(10 * i), .position = {&x, 1}});
        window.segment(window.segments() - 1, last);
        if (last.kind != SegmentKind::stop_tail) std::_Exit(1);
      }
    });
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
