#include "splinecast/boundary_condition.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>

namespace splinecast::core {
namespace {

TEST(Condition, ParsesTheTextThatItPrints) {
  for (const char* text :
       {"natural", "clamped", "halt", "velocity=1,-2.5,3e-07", "acceleration=0.1"}) {
    const auto condition = parse_condition(text);
    ASSERT_TRUE(condition.has_value()) << text;
    EXPECT_EQ(to_string(*condition), text);
  }
  for (const char* text : {"bessel", "parabolic", "natural", "clamped"}) {
    const auto tail = parse_tail(text);
    ASSERT_TRUE(tail.has_value()) << text;
    EXPECT_EQ(to_string(*tail), text);
  }
}

TEST(Condition, RefusesOtherTexts) {
  for (const char* text : {"", "Natural", "natural=1", "velocity", "velocity=", "velocity=1,",
                           "velocity=1,x", "velocity=nan", "halt=0", "rest ", "acceleration=inf"}) {
    EXPECT_FALSE(parse_condition(text).has_value()) << text;
  }
  EXPECT_FALSE(parse_tail("halt").has_value());
}

TEST(Condition, RequiresOneFiniteValuePerDimensionIfItTakesValues) {
  EXPECT_NO_THROW(require_values({ConditionKind::velocity, {1, 2}}, 2));
  EXPECT_NO_THROW(require_values({ConditionKind::halt, {}}, 2));
  EXPECT_THROW(require_values({ConditionKind::velocity, {1}}, 2), std::invalid_argument);
  EXPECT_THROW(require_values({ConditionKind::natural, {0}}, 1), std::invalid_argument);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(require_values({ConditionKind::acceleration, {nan}}, 1), std::invalid_argument);
}

}  // namespace
}  // namespace splinecast::core
