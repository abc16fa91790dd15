#include "splinecast/dimension_kind.hpp"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/polynomial/segment.hpp"
#include "tests/fixtures/curves/rotation.hpp"

namespace splinecast::core {
namespace {

constexpr Dimension kLinear{};
constexpr Dimension kQuaternion{.kind = DimensionKind::quaternion};
constexpr Dimension kWFirst{.kind = DimensionKind::quaternion_wxyz};

DimensionKinds kinds_of(const std::vector<Dimension>& dimensions) {
  return DimensionKinds(dimensions);
}

DimensionKinds one_quaternion(const Dimension& kind = kQuaternion) {
  return kinds_of({kind, kind, kind, kind});
}

/// A number between −size and size.
double any(double size) {
  constexpr int kSteps = 1'000'000;
  return size * *rc::gen::inRange(-kSteps, kSteps + 1) / kSteps;
}

std::vector<double> any_values(std::size_t count, double size) {
  std::vector<double> values(count);
  for (double& value : values) value = any(size);
  return values;
}

double length_of(std::span<const double> q) {
  return std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
}

std::vector<double> any_quaternion() {
  auto q = any_values(4, 1);
  RC_PRE(length_of(q) > 0.1);
  return q;
}

double dot(std::span<const double> a, std::span<const double> b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
}

TEST(DimensionKinds, UnwrappingMovesAPeriodicValueToWithinHalfAPeriodOfItsPredecessor) {
  EXPECT_TRUE(rc::check([] {
    const double period = 0.5 + std::abs(any(400));
    const auto kinds = kinds_of({kLinear, {.kind = DimensionKind::periodic, .period = period}});
    const std::vector<double> before{any(1), any(1e4)};
    const std::vector<double> given{any(1e4), any(1e4)};
    std::vector<double> moved = given;
    kinds.continue_from(before, {.position = moved});
    RC_ASSERT(moved[0] == given[0]);
    RC_ASSERT(std::abs(moved[1] - before[1]) <= period / 2 + 1e-11);
    const double turns = (moved[1] - given[1]) / period;
    RC_ASSERT(std::abs(turns - std::round(turns)) < 1e-9);
    std::vector<double> again = moved;
    kinds.continue_from(before, {.position = again});
    RC_ASSERT(std::abs(again[1] - moved[1]) < 1e-11);
  }));
}

TEST(DimensionKinds, APeriodicPositionIsReadWithinHalfAPeriodOfZero) {
  const auto kinds = kinds_of({{.kind = DimensionKind::periodic, .period = 360}});
  const auto read = [&](double position) {
    State state(1);
    state.ref().position[0] = position;
    state.ref().velocity[0] = 7;
    kinds.normalise(state.ref());
    EXPECT_EQ(state.velocity()[0], 7);
    return state.position()[0];
  };
  EXPECT_EQ(read(179), 179);
  EXPECT_EQ(read(180), -180);
  EXPECT_EQ(read(-180), -180);
  EXPECT_EQ(read(540), -180);
  EXPECT_EQ(read(3611.5), 11.5);
  EXPECT_EQ(read(-181), 179);
}

TEST(DimensionKinds, AQuaternionTakesTheSignNearestToItsPredecessor) {
  EXPECT_TRUE(rc::check([] {
    const auto kinds = one_quaternion(*rc::gen::arbitrary<bool>() ? kQuaternion : kWFirst);
    const auto before = any_quaternion();
    const auto given = any_quaternion();
    auto one = given;
    auto derivative = any_values(4, 5);
    const auto given_derivative = derivative;
    kinds.continue_from(before, {.position = one, .velocity = derivative});
    RC_ASSERT(std::abs(length_of(one) - 1) < 1e-15);
    RC_ASSERT(dot(one, before) >= 0);
    // Position and velocity are multiplied by the same factor.
    const double factor = dot(one, given) / dot(given, given);
    for (std::size_t d = 0; d < 4; ++d) {
      RC_ASSERT(std::abs(one[d] - factor * given[d]) < 1e-14);
      RC_ASSERT(std::abs(derivative[d] - factor * given_derivative[d]) < 1e-12);
    }
    auto other = given;
    for (double& value : other) value = -value;
    kinds.continue_from(before, {.position = other});
    if (dot(one, before) != 0) RC_ASSERT(one == other);
  }));
}

TEST(DimensionKinds, TheFirstWaypointKeepsItsSignAndIsNotUnwrapped) {
  const auto kinds = kinds_of({kQuaternion,
                               kQuaternion,
                               kQuaternion,
                               kQuaternion,
                               {.kind = DimensionKind::periodic, .period = 2}});
  std::vector<double> first{0, 0, 0, -4, 7};
  kinds.continue_from({}, {.position = first});
  EXPECT_EQ(first, (std::vector<double>{0, 0, 0, -1, 7}));
}

TEST(DimensionKinds, AQuaternionOfLengthNearZeroOrAbove1e100IsRefused) {
  const auto kinds = kinds_of({kLinear, kQuaternion, kQuaternion, kQuaternion, kQuaternion});
  EXPECT_TRUE(kinds.takes(std::vector<double>{0, 0, 0, 1e-99, 0}));
  for (const double length : {1e-101, 1e-200, 1e-310, 1e101}) {
    EXPECT_FALSE(kinds.takes(std::vector<double>{0, 0, 0, length, 0})) << length;
  }
  EXPECT_FALSE(kinds.takes(std::vector<double>{1, 0, 0, 0, 0}));
  EXPECT_TRUE(DimensionKinds().takes(std::vector<double>{0, 0, 0, 0}));
  std::vector<double> tiny{5, 0, 0, 3e-99, -4e-99};
  kinds.continue_from({}, {.position = tiny});
  EXPECT_NEAR(tiny[3], 0.6, 1e-15);
  EXPECT_NEAR(tiny[4], -0.8, 1e-15);
}

TEST(DimensionKinds, RefusesInvalidPeriodsAndQuaternions) {
  const auto refusal = [](const std::vector<Dimension>& dimensions) -> std::string {
    try {
      (void)DimensionKinds(dimensions);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "taken";
  };
  for (const double period : {0.0, -1.0, 1e-200, 1e200, std::nan(""), HUGE_VAL}) {
    EXPECT_NE(
        refusal({kLinear, {.kind = DimensionKind::periodic, .period = period}}).find("dimension 1"),
        std::string::npos)
        << period;
  }
  EXPECT_NE(refusal({{.kind = DimensionKind::linear, .period = 3}}).find("period 3"),
            std::string::npos);
  EXPECT_NE(refusal({kLinear, kQuaternion, kQuaternion, kQuaternion}).find("at dimension 1"),
            std::string::npos);
  EXPECT_NE(refusal({kQuaternion, kQuaternion, kWFirst, kWFirst}).find("at dimension 0"),
            std::string::npos);
  EXPECT_EQ(refusal({kQuaternion, kQuaternion, kQuaternion, kQuaternion, kWFirst, kWFirst, kWFirst,
                     kWFirst}),
            "taken");
}

TEST(Dimension, ParsesTheTextThatItPrints) {
  for (const char* text : {"linear", "periodic:360", "periodic:6.283185307179586",
                           "periodic:1e-100", "quaternion", "quaternion-wxyz"}) {
    const auto dimension = parse_dimension(text);
    ASSERT_TRUE(dimension.has_value()) << text;
    EXPECT_EQ(to_string(*dimension), text);
  }
  for (const char* text :
       {"", "periodic", "periodic:", "periodic:0", "periodic:-1", "periodic:nan", "periodic:inf",
        "wrap:1", "periodic:1x", "periodic:1e200", "Linear", "quaternion:4"}) {
    EXPECT_FALSE(parse_dimension(text).has_value()) << text;
  }
}

TEST(DimensionKinds, AnEndConditionWithValuesForAQuaternionIsRefused) {
  const auto kinds = kinds_of({kLinear, kQuaternion, kQuaternion, kQuaternion, kQuaternion});
  EXPECT_NO_THROW(kinds.require_end({.kind = ConditionKind::halt}));
  EXPECT_NO_THROW(kinds.require_end({ConditionKind::velocity, {3, 0, 0, 0, 0}}));
  EXPECT_THROW(kinds.require_end({ConditionKind::velocity, {3, 0, 0, 2, 0}}),
               std::invalid_argument);
}

/// A random quintic, evaluated and normalised as in a reader.
struct Curve {
  std::vector<double> coefficients;

  [[nodiscard]] State at(double u) const {
    State state(4);
    evaluate(kMaxOrder, coefficients, u, state.ref());
    one_quaternion().normalise(state.ref());
    return state;
  }
};

Curve any_curve() {
  Curve curve{.coefficients = any_values(4 * kMaxOrder, 0.5)};
  const auto q = any_quaternion();
  std::ranges::copy(q, curve.coefficients.begin());
  return curve;
}

TEST(DimensionKinds, ReadDerivativesAreThoseOfTheNormalisedCurve) {
  EXPECT_TRUE(rc::check([] {
    const Curve curve = any_curve();
    const State here = curve.at(0);
    RC_ASSERT(std::abs(length_of(here.position()) - 1) < 1e-15);
    // Differences over four points: an error of O(h⁴), and rounding of O(1e-16/h).
    constexpr double h = 2e-4;
    const State a = curve.at(-2 * h);
    const State b = curve.at(-h);
    const State c = curve.at(h);
    const State d = curve.at(2 * h);
    double scale = 1;
    for (const double value : here.values()) scale = std::max(scale, std::abs(value));
    for (std::size_t i = 0; i < 12; ++i) {
      const double slope =
          (a.values()[i] - 8 * b.values()[i] + 8 * c.values()[i] - d.values()[i]) / (12 * h);
      RC_ASSERT(std::abs(slope - here.values()[i + 4]) < 1e-6 * scale * scale);
    }
  }));
}

TEST(DimensionKinds, AReadVelocityIsOrthogonalToItsQuaternion) {
  EXPECT_TRUE(rc::check([] {
    const State state = any_curve().at(0);
    const double speed = length_of(state.velocity());
    RC_ASSERT(std::abs(dot(state.position(), state.velocity())) <= 1e-14 * (1 + speed));
    // And (q·q̇)˙ = 0: q·q̈ = −|q̇|².
    const double scale = 1 + speed * speed + length_of(state.acceleration());
    RC_ASSERT(std::abs(dot(state.position(), state.acceleration()) + speed * speed) <=
              1e-14 * scale);
  }));
}

TEST(DimensionKinds, NormaliseQuaternionsGivesTheStateOfTheReadCurve) {
  EXPECT_TRUE(rc::check([] {
    const Curve curve = any_curve();
    State raw(4);
    evaluate(kMaxOrder, curve.coefficients, 0, raw.ref());
    const StateRef ref = raw.ref();
    one_quaternion().normalise_quaternions(ref.position, ref.velocity, ref.acceleration);
    const State read = curve.at(0);
    for (std::size_t i = 0; i < 12; ++i) RC_ASSERT(raw.values()[i] == read.values()[i]);
  }));
}

TEST(DimensionKinds, AZeroQuaternionIsLeftUnchanged) {
  State state(4);
  state.ref().velocity[2] = 5;
  one_quaternion().normalise(state.ref());
  EXPECT_EQ(length_of(state.position()), 0);
  EXPECT_EQ(state.velocity()[2], 5);
}

/// Position, velocity and acceleration of a rotation at rate `rate` about a unit axis.
State rotating(const Vector3& axis, double rate, double seconds) {
  State state(4);
  const double half = rate / 2;
  const double s = std::sin(half * seconds);
  const double c = std::cos(half * seconds);
  const auto put = [&](std::span<double> out, double vector, double scalar) {
    for (std::size_t k = 0; k < 3; ++k) out[k] = axis[k] * vector;
    out[3] = scalar;
  };
  put(state.ref().position, s, c);
  put(state.ref().velocity, half * c, -half * s);
  put(state.ref().acceleration, -half * half * s, -half * half * c);
  return state;
}

TEST(AngularMotion, OfASteadyRotationIsItsRateAboutItsAxis) {
  const Vector3 axis{2.0 / 3, -1.0 / 3, 2.0 / 3};
  const double rate = 5;
  for (const double seconds : {0.0, 0.3, 1.0, 7.7}) {
    const State state = rotating(axis, rate, seconds);
    const auto motion =
        angular_motion({}, state.position(), state.velocity(), state.acceleration());
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_NEAR(motion.velocity[k], rate * axis[k], 1e-14);
      EXPECT_NEAR(motion.acceleration[k], 0, 1e-14);
    }
  }
}

TEST(AngularMotion, OfAConingBodyIsExpressedInTheBodyFrame) {
  const testing::Coning coning;
  constexpr double h = 1e-3;
  for (const double seconds : {0.0, 0.4, 1.3}) {
    // Sixth-order differences of the exact quaternion.
    std::array<double, 4> v{};
    std::array<double, 4> a{};
    const auto q = coning.quaternion(seconds);
    for (std::size_t d = 0; d < 4; ++d) {
      const auto at = [&](int k) { return coning.quaternion(seconds + k * h)[d]; };
      v[d] = (45 * (at(1) - at(-1)) - 9 * (at(2) - at(-2)) + (at(3) - at(-3))) / (60 * h);
      a[d] = (270 * (at(1) + at(-1)) - 27 * (at(2) + at(-2)) + 2 * (at(3) + at(-3)) - 490 * q[d]) /
             (180 * h * h);
    }
    const auto motion = angular_motion({}, q, v, a);
    EXPECT_LT(testing::difference(motion.velocity, coning.motion(seconds).velocity), 1e-11);
    EXPECT_LT(testing::difference(motion.acceleration, coning.motion(seconds).acceleration), 1e-8);
  }
}

TEST(AngularMotion, DependsNeitherOnSignNorOnTheOrderInMemory) {
  EXPECT_TRUE(rc::check([] {
    const State state = any_curve().at(0);
    const auto turned = [](std::span<const double> xyzw) {
      return std::vector<double>{-xyzw[3], -xyzw[0], -xyzw[1], -xyzw[2]};
    };
    const auto one = angular_motion({}, state.position(), state.velocity(), state.acceleration());
    const auto other = angular_motion({.first = 0, .w_first = true}, turned(state.position()),
                                      turned(state.velocity()), turned(state.acceleration()));
    RC_ASSERT(one.velocity == other.velocity);
    RC_ASSERT(one.acceleration == other.acceleration);
  }));
}

}  // namespace
}  // namespace splinecast::core
