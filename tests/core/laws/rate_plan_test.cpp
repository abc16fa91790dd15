#include "core/laws/rate_plan.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "core/forms/entry.hpp"
#include "core/polynomial/segment.hpp"

namespace splinecast::core {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr double kLargest = 1;

/// A law and its commanders, as the law's solver runs them.
class Law {
 public:
  explicit Law(const std::vector<double>& rates) {
    for (const double rate : rates) {
      bounds_.emplace_back(rate);
      requests_.push_back({rate, milliseconds(100)});
    }
    curve_ = RateCurve(target());
  }

  /// Takes a request at `t`, or when a plan can begin. Returns that time.
  Time request(std::size_t commander, Time t, const RateRequest& request) {
    t = plan_begin(curve_, t);
    bounds_[commander] = bound_after(bounds_[commander], t, request);
    requests_[commander] = request;
    newest_ = request.ramp;
    step(t);
    return t;
  }
  void step(Time t) {
    const auto planned = plan_rate(curve_, plan_begin(curve_, t), bounds_, target(), newest_);
    if (planned) curve_ = *planned;
  }

  [[nodiscard]] double target() const {
    return std::ranges::min(requests_, {}, &RateRequest::rate).rate;
  }
  [[nodiscard]] const RateCurve& curve() const { return curve_; }
  [[nodiscard]] const std::vector<RateCurve>& bounds() const { return bounds_; }
  [[nodiscard]] double excess(Time from) const {
    double most = -1;
    for (const RateCurve& bound : bounds_) {
      most = std::max(most, largest_excess(curve_, bound, from));
    }
    return most;
  }
  /// When all ramps have ended.
  [[nodiscard]] Time end() const {
    Time end = curve_.end();
    for (const RateCurve& bound : bounds_) end = std::max(end, bound.end());
    return end;
  }

 private:
  std::vector<RateCurve> bounds_;
  std::vector<RateRequest> requests_;
  RateCurve curve_{1};
  Time newest_ = milliseconds(100);
};

TEST(RateCurve, IsACubicHermiteInterpolant) {
  RateCurve curve(Time(0), {0.25, 2});
  curve.add(0.75, milliseconds(500));
  const RateState begin = curve.at(Time(0));
  EXPECT_DOUBLE_EQ(begin.rate, 0.25);
  EXPECT_DOUBLE_EQ(begin.slope, 2);
  for (int i = 1; i < 50; ++i) {
    const Time t = milliseconds(10 * i);
    const double step = 1e-6;
    const double before = curve.at(t - Time(1000)).rate;
    const double after = curve.at(t + Time(1000)).rate;
    EXPECT_NEAR(curve.at(t).slope, (after - before) / (2 * step), 1e-6) << i;
  }
  EXPECT_DOUBLE_EQ(curve.at(milliseconds(500)).rate, 0.75);
  EXPECT_EQ(curve.at(seconds(5)).slope, 0);
}

TEST(RateCurve, IsThatOfTheQuinticsBetweenTheStatesAtItsEnds) {
  RateCurve curve(Time(0), {0.25, 2});
  curve.add(0.75, milliseconds(40));
  curve.add(0, milliseconds(500));
  LawState left{.time = Time(0), .position = 5, .rate = 0.25, .slope = 2};
  for (const RatePiece& piece : curve.pieces()) {
    const LawState right = end_of_piece(left, piece.end_rate, piece.length);
    Segment segment(1);
    build_entry({.time = left.time,
                 .position = {&left.position, 1},
                 .velocity = {&left.rate, 1},
                 .acceleration = {&left.slope, 1}},
                {.time = right.time,
                 .position = {&right.position, 1},
                 .velocity = {&right.rate, 1},
                 .acceleration = {&right.slope, 1}},
                segment);
    State state(1);
    for (int i = 0; i <= 100; ++i) {
      const Time t = piece.begin + i * piece.length / 100;
      evaluate(segment.order, segment.coefficients, to_seconds(t - segment.left), state.ref());
      EXPECT_NEAR(state.velocity()[0], curve.at(t).rate, 1e-12);
      EXPECT_NEAR(state.acceleration()[0], curve.at(t).slope, 1e-10);
    }
    left = right;
  }
}

TEST(RateCurve, TheExcessIsTheLargestOfAllInstants) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> unit;
  const auto any = [&] {
    RateCurve curve(milliseconds(static_cast<int>(50 * unit(random))),
                    {unit(random), 8 * unit(random) - 4});
    for (int i = 0; i < 3; ++i)
      curve.add(unit(random), Time(1 + static_cast<int>(1e8 * unit(random))));
    return curve;
  };
  for (int i = 0; i < 2000; ++i) {
    const RateCurve curve = any();
    const RateCurve bound = any();
    double most = -10;
    for (Time t = milliseconds(50); t < milliseconds(400); t += Time(50'000)) {
      most = std::max(most, curve.at(t).rate - bound.at(t).rate);
    }
    const double found = largest_excess(curve, bound, milliseconds(50));
    ASSERT_GE(found, most - 1e-12) << i;
    ASSERT_NEAR(found, most, 5e-3) << i;
  }
}

TEST(RatePlan, OfOneCommanderIsItsBound) {
  Law law({1});
  law.request(0, seconds(1), {0.3, milliseconds(500)});
  EXPECT_EQ(law.curve().end(), seconds(1) + milliseconds(500));
  law.request(0, seconds(1) + milliseconds(200), {0, milliseconds(100)});
  law.request(0, seconds(1) + milliseconds(230), {1, milliseconds(400)});
  for (int i = 0; i < 2000; ++i) {
    const Time t = seconds(1) + milliseconds(230 + i);
    ASSERT_LE(law.curve().at(t).rate, law.bounds()[0].at(t).rate + 1e-12);
  }
  EXPECT_EQ(law.curve().last_rate(), 1);
}

TEST(RatePlan, ASlowHoldWhileTheRateRisesDoesNotRaiseItFurther) {
  Law law({0.3});
  law.request(0, seconds(1), {0.5, seconds(1)});
  const Time t = seconds(1) + milliseconds(500);
  ASSERT_NEAR(law.curve().at(t).rate, 0.4, 1e-12);
  law.request(0, t, {0.2, seconds(60)});
  EXPECT_LE(law.curve().at(t + seconds(6)).rate, 0.5);
  EXPECT_EQ(law.curve().last_rate(), 0.2);
}

TEST(RatePlan, AFasterStopToTheSameRateIsTaken) {
  Law law({1, 1});
  law.request(0, seconds(1), {0, seconds(60)});
  law.request(1, seconds(2), {0, milliseconds(100)});
  EXPECT_EQ(law.curve().at(seconds(2) + milliseconds(100)).rate, 0);
}

TEST(RatePlan, ARequestForTheRateThatIsThereKeepsTheCurve) {
  Law law({1, 1});
  law.request(0, seconds(1), {0, milliseconds(100)});
  const Time end = law.curve().end();
  law.request(0, seconds(1) + milliseconds(30), {0, seconds(60)});
  EXPECT_EQ(law.curve().end(), end);
}

TEST(RatePlan, ARiseIsAsLongAsTheReleasersRamp) {
  Law law({0, 0.5});
  law.request(0, seconds(1), {1, seconds(3)});
  EXPECT_EQ(law.curve().end(), seconds(4));
  EXPECT_EQ(law.curve().last_rate(), 0.5);
}

/// Random requests of 1 to 16 commanders, in bursts and apart.
class RandomRequests {
 public:
  /// One sequence of requests, until the law has the least rate.
  void run(std::size_t commanders) {
    std::vector<double> rates(commanders);
    for (double& rate : rates) rate = unit_(random_) < 0.5 ? kLargest : unit_(random_);
    Law law(rates);
    Time t = seconds(1);
    double asked = 0;
    for (int i = 0; i < 12; ++i) {
      t += log_uniform(1e-4, unit_(random_) < 0.7 ? 0.3 : 30);
      const RateCurve present = law.curve();
      const std::size_t who = random_() % commanders;
      t = law.request(who, t, any_request());
      const RateState before = present.at(t);
      asked = std::max(asked, law.bounds()[who].steepest());
      if (asked > 0) ratios_.push_back(law.curve().steepest() / asked);
      // A plan begins in the state that the law has.
      const RateState after = law.curve().at(t);
      ASSERT_NEAR(after.rate, before.rate, 1e-12);
      ASSERT_NEAR(after.slope, before.slope, 1e-9 * (1 + std::abs(before.slope)));
      most_ = std::max(most_, law.excess(t));
      for (const RatePiece& piece : law.curve().pieces()) {
        ASSERT_GE(piece.length, kShortestPiece);
      }
    }
    settle(law, t);
  }

  [[nodiscard]] double largest_excess() const { return most_; }
  /// How steep 999 of 1000 plans are at most, relative to the steepest bound.
  [[nodiscard]] double steepness() {
    std::ranges::sort(ratios_);
    return ratios_[ratios_.size() * 999 / 1000];
  }

 private:
  Time log_uniform(double from, double to) {
    return Time(static_cast<Time::rep>(1e9 * from * std::pow(to / from, unit_(random_))));
  }
  RateRequest any_request() {
    const double kind = unit_(random_);
    return {.rate = kind < 0.35  ? 0
                    : kind < 0.6 ? kLargest
                                 : unit_(random_),
            .ramp = log_uniform(1e-3, unit_(random_) < 0.8 ? 1 : 60)};
  }
  /// Rises that did not pass at first are tried again.
  void settle(Law& law, Time t) {
    for (int i = 0; i < 100 && law.curve().last_rate() != law.target(); ++i) {
      t += milliseconds(100) + (law.end() - std::min(t, law.end())) / 8;
      law.step(t);
      most_ = std::max(most_, law.excess(t));
    }
    ASSERT_EQ(law.curve().last_rate(), law.target());
  }

  std::mt19937_64 random_{7};
  std::uniform_real_distribution<double> unit_;
  std::vector<double> ratios_;
  double most_ = 0;
};

TEST(RatePlan, OfRandomRequestsExceedsNoBoundAndReachesTheLeastRate) {
  RandomRequests requests;
  for (std::size_t i = 0; i < 20'000 && !::testing::Test::HasFailure(); ++i) {
    requests.run(1 + i % (i % 3 == 0 ? 16 : 4));
  }
  EXPECT_LE(requests.largest_excess(), 1e-9);
  EXPECT_LE(requests.steepness(), 4);
}

}  // namespace
}  // namespace splinecast::core
