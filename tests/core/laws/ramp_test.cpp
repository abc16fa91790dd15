#include "core/laws/ramp.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "core/forms/entry.hpp"
#include "core/polynomial/segment.hpp"

namespace splinecast::core {
namespace {

using std::chrono::milliseconds;

constexpr double kLargest = 1.5;

/// The quintic of a part of a ramp, as a law's board has it.
Segment part(const LawState& from, const LawState& to) {
  Segment segment(1);
  build_entry({.time = from.time,
               .position = {&from.position, 1},
               .velocity = {&from.rate, 1},
               .acceleration = {&from.slope, 1}},
              {.time = to.time,
               .position = {&to.position, 1},
               .velocity = {&to.rate, 1},
               .acceleration = {&to.slope, 1}},
              segment);
  return segment;
}

State at(const Segment& segment, double share) {
  State state(1);
  const double h = to_seconds(segment.right - segment.left);
  evaluate(segment.order, segment.coefficients, share * h, state.ref());
  return state;
}

TEST(LawRamp, IsACubicChangeOfTheRate) {
  const LawState from{.time = Time(0), .position = 5, .rate = 1, .slope = 0};
  const Ramp ramp = plan_ramp(from, 0.25, milliseconds(500), kLargest);
  ASSERT_EQ(ramp.ends().size(), 1U);
  const LawState& end = ramp.ends()[0];
  EXPECT_EQ(end.time, milliseconds(500));
  EXPECT_EQ(end.rate, 0.25);
  EXPECT_EQ(end.slope, 0);
  EXPECT_DOUBLE_EQ(end.position, 5 + 0.5 * (1 + 0.25) / 2);
  const Segment segment = part(from, end);
  for (int i = 0; i <= 100; ++i) {
    const double w = i / 100.0;
    EXPECT_NEAR(at(segment, w).velocity()[0], 1 - 0.75 * w * w * (3 - 2 * w), 1e-12);
  }
}

/// A ramp that interrupts another one at a random instant.
struct Interruption {
  LawState from;
  double rate;
  Time duration;
};

Interruption random_interruption(std::mt19937_64& random) {
  std::uniform_real_distribution<double> share(0, 1);
  const auto ramp_time = [&] { return Time(std::llround(1e6 * std::pow(10, 4 * share(random)))); };
  const auto rate = [&] {
    const double u = share(random);
    return u < 0.2 ? 0.0 : u < 0.3 ? kLargest : kLargest * share(random);
  };
  const LawState begin{.time = Time(1), .position = 10 * share(random), .rate = rate()};
  const Ramp first = plan_ramp(begin, rate(), ramp_time(), kLargest);
  const Segment segment = part(begin, first.ends()[0]);
  const double w = share(random) < 0.1 ? 0.9999 : share(random);
  const State state = at(segment, w);
  const Time elapsed(std::llround(w * static_cast<double>((segment.right - segment.left).count())));
  return {.from = {.time = begin.time + elapsed,
                   .position = state.position()[0],
                   .rate = std::clamp(state.velocity()[0], 0.0, kLargest),
                   .slope = state.acceleration()[0]},
          .rate = rate(),
          .duration = ramp_time()};
}

TEST(LawRamp, StaysWithinItsRatesIfItInterruptsAnotherRamp) {
  std::mt19937_64 random(11);
  for (int i = 0; i < 20'000; ++i) {
    const Interruption cut = random_interruption(random);
    const Ramp ramp = plan_ramp(cut.from, cut.rate, cut.duration, kLargest);
    LawState before = cut.from;
    for (const LawState& end : ramp.ends()) {
      ASSERT_GT(end.time, before.time);
      const Segment segment = part(before, end);
      // Positions are rounded, and the rate follows from their differences.
      const double h = to_seconds(end.time - before.time);
      const double rounding = 1e-12 + 1e-15 * std::abs(end.position) / h;
      const double low = std::min(before.rate, end.rate) - rounding;
      const double high = std::max(before.rate, end.rate) + rounding;
      for (int k = 0; k <= 32; ++k) {
        const State state = at(segment, k / 32.0);
        ASSERT_GE(state.velocity()[0], low) << i;
        ASSERT_LE(state.velocity()[0], high) << i;
        if (ramp.ends().size() == 2 && &end == ramp.ends().data()) {
          ASSERT_LE(std::abs(state.acceleration()[0]),
                    std::abs(cut.from.slope) * (1 + 1e-12) + 10 * rounding / h);
        }
      }
      before = end;
    }
    ASSERT_EQ(before.rate, cut.rate);
    ASSERT_EQ(before.slope, 0);
    ASSERT_GE(before.time - cut.from.time, cut.duration);
    ASSERT_LE(before.time - cut.from.time, cut.duration + cut.duration / 4 + Time(1));
  }
}

TEST(LawRamp, HasThePeaksThatAreComputed) {
  const LawState from{.time = Time(0), .position = 0, .rate = 0.2, .slope = 0};
  const Ramp ramp = plan_ramp(from, 1, milliseconds(250), kLargest);
  const Segment segment = part(from, ramp.ends()[0]);
  double slope = 0;
  double curvature = 0;
  for (int i = 0; i <= 1000; ++i) {
    const State state = at(segment, i / 1000.0);
    slope = std::max(slope, std::abs(state.acceleration()[0]));
    curvature = std::max(curvature, std::abs(state.jerk()[0]));
  }
  const RampPeaks peaks = peaks_of_ramp(0.2, 1, milliseconds(250));
  EXPECT_NEAR(peaks.slope, slope, 1e-6 * slope);
  EXPECT_NEAR(peaks.curvature, curvature, 1e-6 * curvature);
}

}  // namespace
}  // namespace splinecast::core
