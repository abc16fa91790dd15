#include "core/polynomial/roots.hpp"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace splinecast::core {
namespace {

/// Coefficients of Π (s − root), times a leading factor.
std::vector<double> with_roots(const std::vector<double>& roots, double leading) {
  std::vector<double> c{leading};
  for (const double root : roots) {
    c.insert(c.begin(), 0);
    for (std::size_t k = 0; k + 1 < c.size(); ++k) c[k] -= root * c[k + 1];
  }
  return c;
}

std::vector<double> found(const std::vector<double>& c) {
  const Roots roots = unit_roots(c);
  return {roots.begin(), roots.end()};
}

TEST(Roots, OfAProductOfLinearFactorsAreThoseInTheUnitInterval) {
  EXPECT_TRUE(rc::check("roots", [](std::uint64_t seed) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> place(0.02, 0.08);
    const std::size_t degree = 1 + seed % 7;
    std::vector<double> roots;
    double at = -0.2;
    while (roots.size() < degree) roots.push_back(at += place(random) + 0.1);
    const auto got = found(with_roots(roots, seed % 2 == 0 ? 3 : -1e-7));
    std::erase_if(roots, [](double s) { return s < 0 || s > 1; });
    RC_ASSERT(got.size() == roots.size());
    for (std::size_t i = 0; i < roots.size(); ++i) {
      RC_ASSERT(std::abs(got[i] - roots[i]) < 1e-9);
    }
  }));
}

TEST(Roots, OfNearlyLinearAndNearlyQuadraticPolynomialsKeepTheirDigits) {
  for (const double tiny : {1e-10, -1e-16, 1e-30, 1e-300}) {
    const auto linear = found({-0.3, 1, tiny});
    ASSERT_EQ(linear.size(), 1U);
    EXPECT_NEAR(linear[0], 0.3, 0.1 * std::abs(tiny) + 2e-16);
    const auto quadratic = found({0.06, -0.5, 1, tiny});
    ASSERT_EQ(quadratic.size(), 2U);
    EXPECT_NEAR(quadratic[0], 0.2, std::abs(tiny) + 4e-16);
    EXPECT_NEAR(quadratic[1], 0.3, std::abs(tiny) + 4e-16);
  }
}

TEST(Roots, AtTangenciesAndAtTheEndsAreFound) {
  EXPECT_EQ(found({0.25, -1, 1}), std::vector{0.5});
  EXPECT_EQ(found({0.25 + 1e-12, -1, 1}), std::vector<double>{});
  EXPECT_EQ(found({0, 1}), std::vector{0.0});
  EXPECT_EQ(found({-1, 1}), std::vector{1.0});
}

TEST(Roots, ADoubleRootIsFoundBesideASingleOne) {
  const auto exact = found(with_roots({0.25, 0.25, 0.75}, 1));  // coefficients without rounding
  ASSERT_EQ(exact.size(), 2U);
  EXPECT_EQ(exact[0], 0.25);
  EXPECT_NEAR(exact[1], 0.75, 2e-16);
  // Rounded coefficients have two roots near the double one, or none.
  const auto rounded = found(with_roots({0.3, 0.3, 0.7}, 1));
  ASSERT_FALSE(rounded.empty());
  EXPECT_LE(rounded.size(), 3U);
  EXPECT_NEAR(rounded.back(), 0.7, 1e-14);
  for (std::size_t i = 0; i + 1 < rounded.size(); ++i) EXPECT_NEAR(rounded[i], 0.3, 1e-7);
}

TEST(Roots, AreFoundIfTheyCoincideAndAtTheHighestDegree) {
  const auto thrice = found(with_roots({0.4, 0.4, 0.4}, 1));
  ASSERT_FALSE(thrice.empty());
  for (const double s : thrice) EXPECT_NEAR(s, 0.4, 1e-5);
  std::vector<double> power(kMaxRootCoefficients);  // s^15 = 1/2
  power[0] = -0.5;
  power.back() = 1;
  const auto high = found(power);
  ASSERT_EQ(high.size(), 1U);
  EXPECT_NEAR(high[0], std::pow(0.5, 1.0 / 15), 2e-16);
}

TEST(Roots, AConstantHasNone) {
  EXPECT_TRUE(found({}).empty());
  EXPECT_TRUE(found({0}).empty());
  EXPECT_TRUE(found({0, 0, 0}).empty());
  EXPECT_TRUE(found({1, 0}).empty());
  EXPECT_EQ(found({0, 1}), std::vector{0.0});
}

TEST(Roots, TerminateForAnyCoefficients) {
  EXPECT_TRUE(rc::check("any coefficients", [](const std::vector<double>& some) {
    std::vector<double> c(some.begin(), some.begin() + static_cast<std::ptrdiff_t>(std::min(
                                                           some.size(), kMaxRootCoefficients)));
    const auto roots = found(c);
    RC_ASSERT(std::ranges::is_sorted(roots));
    RC_ASSERT(std::ranges::all_of(roots, [](double s) { return s >= 0 && s <= 1; }));
  }));
  const double nan = std::nan("");
  EXPECT_LE(found({nan, 1, nan, 2, nan}).size(), 5U);
  EXPECT_LE(found({1, INFINITY, -INFINITY, 2, -3}).size(), 5U);
}

}  // namespace
}  // namespace splinecast::core
