#include "core/laws/motion.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <random>
#include <vector>

#include "core/polynomial/segment.hpp"
#include "splinecast/state.hpp"

namespace splinecast::core {
namespace {

std::vector<double> values_of(const State& state) {
  return {state.values().begin(), state.values().end()};
}

TEST(LawMotion, HasTheBitsOfTheEvaluationAndTheChainRuleOneAfterTheOther) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> number(-2, 2);
  for (std::size_t dimensions = 1; dimensions <= 9; ++dimensions) {
    for (int order = 1; order <= kMaxOrder; ++order) {
      std::vector<double> coefficients(static_cast<std::size_t>(order) * dimensions);
      std::ranges::generate(coefficients, [&] { return number(random); });
      const LawRates law{.rate = number(random), .slope = number(random), .curvature = 0.5};
      const double u = number(random);
      State expected(dimensions);
      evaluate(order, coefficients, u, expected.ref());
      follow(law, expected.ref());
      State found(dimensions);
      evaluate(order, coefficients, u, law, found.ref());
      EXPECT_EQ(values_of(found), values_of(expected)) << dimensions << ' ' << order;
      if (dimensions > 1 || order < kMaxOrder) continue;
      evaluate(order, coefficients, u, expected.ref());
      const auto one = evaluate_one(coefficients.data(), u);
      EXPECT_EQ(std::vector(one.begin(), one.end()), values_of(expected));
    }
  }
}

}  // namespace
}  // namespace splinecast::core
