#include "core/polynomial/segment.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <vector>

#include "splinecast/eigen.hpp"
#include "tests/fixtures/curves/mesh.hpp"

namespace splinecast::core {
namespace {

using testing::random_values;

constexpr Time kLeft{1'000'000'000};
constexpr Time kRight{1'250'000'000};

struct Ends {
  std::vector<double> x0, x1, v0, v1, chord;
  explicit Ends(std::size_t dimensions)
      : x0(random_values(1, dimensions)),
        x1(random_values(2, dimensions)),
        v0(random_values(3, dimensions)),
        v1(random_values(4, dimensions)),
        chord(dimensions) {
    for (std::size_t d = 0; d < dimensions; ++d) chord[d] = (x1[d] - x0[d]) / 0.25;
  }
  std::vector<double> at_rest = std::vector<double>(x0.size());

  [[nodiscard]] Interval interval(bool halts_left, bool halts_right) const {
    const std::span<const double> none;
    const std::span<const double> zeros(at_rest);
    return {kLeft,
            kRight,
            0.25,
            x0,
            chord,
            v0,
            v1,
            halts_left ? zeros : none,
            halts_right ? zeros : none};
  }
};

void expect_near(std::span<const double> got, std::span<const double> wanted, double tolerance) {
  ASSERT_EQ(got.size(), wanted.size());
  for (std::size_t d = 0; d < got.size(); ++d) EXPECT_NEAR(got[d], wanted[d], tolerance) << d;
}

TEST(Segment, EvaluateGivesTheBitsOfEvaluateDerivativeForAnyOrderAndDimensions) {
  for (int order = 1; order <= kMaxOrder; ++order) {
    for (std::size_t dimensions = 1; dimensions <= 9; ++dimensions) {
      auto c = random_values(5, static_cast<std::size_t>(order) * dimensions);
      c.back() = -3;  // 0 · (−3) is −0
      State state(dimensions);
      evaluate(order, c, 0.7, state.ref());
      const StateRef whole = state.ref();
      const std::array derivatives{whole.position, whole.velocity, whole.acceleration, whole.jerk};
      std::vector<double> single(dimensions);
      for (int r = 0; r < 4; ++r) {
        evaluate_derivative(order, c, 0.7, r, single);
        const auto& wanted = derivatives[static_cast<std::size_t>(r)];
        for (std::size_t d = 0; d < dimensions; ++d) {
          EXPECT_EQ(std::bit_cast<std::uint64_t>(wanted[d]),
                    std::bit_cast<std::uint64_t>(single[d]))
              << "order " << order << ", derivative " << r << ", dimension " << d;
        }
      }
    }
  }
}

constexpr std::array kEach{Derivatives::position, Derivatives::velocity, Derivatives::acceleration,
                           Derivatives::jerk};

/// What evaluate_many writes with a stride that is `gap` doubles longer than needed.
std::vector<double> written_by_many(int order, std::span<const double> c, std::size_t dimensions,
                                    std::span<const double> u, Derivatives which, std::size_t gap) {
  constexpr double kUntouched = -77;
  const std::size_t stride = count(which) * dimensions + gap;
  std::vector<double> out(u.size() * stride, kUntouched);
  evaluate_many(order, c, dimensions, u, which, out, stride);
  return out;
}

std::vector<double> written_by_evaluate(int order, std::span<const double> c,
                                        std::size_t dimensions, std::span<const double> u,
                                        Derivatives which, std::size_t gap) {
  std::vector<double> out;
  State state(dimensions);
  const StateRef ref = state.ref();
  const std::array derivatives{ref.position, ref.velocity, ref.acceleration, ref.jerk};
  for (const double at : u) {
    evaluate(order, c, at, ref);
    for (std::size_t r = 0; r < kEach.size(); ++r) {
      if (!contains(which, kEach[r])) continue;
      out.insert(out.end(), derivatives[r].begin(), derivatives[r].end());
    }
    out.insert(out.end(), gap, -77);
  }
  return out;
}

TEST(Segment, EvaluateManyGivesTheBitsOfEvaluate) {
  for (int order = 1; order <= kMaxOrder + 1; ++order) {
    for (const std::size_t dimensions : {1U, 2U, 3U, 4U, 5U, 6U, 7U, 8U, 9U, 64U}) {
      auto c = random_values(5, static_cast<std::size_t>(order) * dimensions);
      c.back() = -3;  // 0 · (−3) is −0
      for (const std::size_t times : {0U, 1U, 2U, 23U, 24U, 25U, 60U}) {
        auto u = random_values(6, times);
        if (times > 1) u[1] = 0;
        for (int set = 0; set <= 15; ++set) {
          const auto which = static_cast<Derivatives>(set);
          const auto got = written_by_many(order, c, dimensions, u, which, 3);
          const auto wanted = written_by_evaluate(order, c, dimensions, u, which, 3);
          ASSERT_TRUE(std::ranges::equal(got, wanted, {}, std::bit_cast<std::uint64_t, double>,
                                         std::bit_cast<std::uint64_t, double>))
              << "order " << order << ", dimensions " << dimensions << ", times " << times
              << ", set " << set;
        }
      }
    }
  }
}

TEST(Derivatives, CombineLikeASet) {
  constexpr Derivatives kBoth = Derivatives::position | Derivatives::jerk;
  EXPECT_EQ(count(kBoth), 2U);
  EXPECT_TRUE(contains(kBoth, Derivatives::jerk));
  EXPECT_FALSE(contains(kBoth, Derivatives::velocity | Derivatives::jerk));
  EXPECT_EQ(count(Derivatives::none), 0U);
  EXPECT_EQ(kEach[0] | kEach[1] | kEach[2] | kEach[3], Derivatives::all);
}

TEST(Segment, EvaluatesEachDerivativeOfItsPolynomial) {
  for (const int order : {4, 6}) {
    const auto c = random_values(5, static_cast<std::size_t>(order) * 3);
    State state(3);
    const double u = 0.7;
    evaluate(order, c, u, state.ref());
    for (std::size_t d = 0; d < 3; ++d) {
      double p = 0;
      double v = 0;
      double a = 0;
      double j = 0;
      for (int k = 0; k < order; ++k) {
        const double ck = c[static_cast<std::size_t>(k) * 3 + d];
        p += ck * std::pow(u, k);
        if (k >= 1) v += ck * k * std::pow(u, k - 1);
        if (k >= 2) a += ck * k * (k - 1) * std::pow(u, k - 2);
        if (k >= 3) j += ck * k * (k - 1) * (k - 2) * std::pow(u, k - 3);
      }
      EXPECT_NEAR(state.position()[d], p, 1e-14);
      EXPECT_NEAR(state.velocity()[d], v, 1e-14);
      EXPECT_NEAR(state.acceleration()[d], a, 1e-13);
      EXPECT_NEAR(state.jerk()[d], j, 1e-13);
    }
  }
}

TEST(Segment, AnOrderSixPolynomialWithoutItsHighPowersIsTheCubicBitForBit) {
  auto c = random_values(6, 24);
  std::fill(c.begin() + 16, c.end(), 0.0);
  State cubic(4);
  State quintic(4);
  for (const double u : {0.0, 1e-9, 0.01, 0.3, 2.5}) {
    evaluate(4, c, u, cubic.ref());
    evaluate(6, c, u, quintic.ref());
    EXPECT_TRUE(std::ranges::equal(cubic.values(), quintic.values())) << u;
  }
}

TEST(Segment, HasTheGivenPositionsAndVelocitiesAtBothEndsAsCubicAndAsQuintic) {
  const Ends ends(5);
  for (const bool left : {false, true}) {
    for (const bool right : {false, true}) {
      Segment segment(5);
      build_segment(ends.interval(left, right), segment);
      EXPECT_EQ(segment.order, left || right ? 6 : 4);
      State state(5);
      evaluate(segment.order, segment.coefficients, 0, state.ref());
      expect_near(state.position(), ends.x0, 0);
      expect_near(state.velocity(), ends.v0, 0);
      evaluate(segment.order, segment.coefficients, 0.25, state.ref());
      expect_near(state.position(), ends.x1, 1e-14);
      expect_near(state.velocity(), ends.v1, 1e-13);
    }
  }
}

TEST(Segment, AFullStopAtOneEndHasNoAccelerationAndTheOtherEndKeepsThatOfTheCubic) {
  const Ends ends(3);
  const Interval halting = ends.interval(true, false);
  Segment cubic(3);
  Segment quintic(3);
  build_segment(ends.interval(false, false), cubic);
  build_segment(halting, quintic);
  State state(3);
  State wanted(3);
  evaluate(quintic.order, quintic.coefficients, 0, state.ref());
  expect_near(state.acceleration(), std::vector<double>(3), 0);
  evaluate(quintic.order, quintic.coefficients, 0.25, state.ref());
  evaluate(cubic.order, cubic.coefficients, 0.25, wanted.ref());
  expect_near(state.acceleration(), wanted.acceleration(), 1e-10);
  std::vector<double> at_end(3);
  write_right_acceleration(halting, at_end);
  expect_near(at_end, wanted.acceleration(), 1e-12);
  write_left_acceleration(halting, at_end);
  EXPECT_EQ(at_end, std::vector<double>(3));
}

TEST(Segment, FixedSizeEigenStatesAreTheSameMemory) {
  const auto c = random_values(10, 12);
  EigenState<3> fixed;
  State state(3);
  evaluate(4, c, 0.3, fixed.ref());
  evaluate(4, c, 0.3, state.ref());
  EXPECT_EQ(fixed.velocity, as_vector<3>(state.velocity()));
  EXPECT_EQ(as_vector(state.jerk()), fixed.jerk);
}

}  // namespace
}  // namespace splinecast::core
