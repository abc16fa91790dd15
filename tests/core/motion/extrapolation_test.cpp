#include "core/motion/extrapolation.hpp"

#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <cmath>
#include <vector>

#include "core/forms/stop.hpp"
#include "tests/fixtures/curves/mesh.hpp"

namespace splinecast::core {
namespace {

using std::chrono::milliseconds;

/// A window whose waypoints are a random walk.
SlidingWindow walk(std::uint64_t seed, std::size_t dimensions, const WindowOptions& how = {},
                   std::size_t knots = 12) {
  const testing::Mesh mesh = testing::random_mesh(seed, knots, dimensions, 3);
  SlidingWindow window(dimensions, how);
  for (std::size_t i = 0; i < knots; ++i) window.append({mesh.times[i], mesh.position(i), {}, {}});
  return window;
}

State state_of(const Extrapolation& extrapolation, Time t, std::size_t dimensions) {
  State state(dimensions);
  extrapolation.state_at(t, state.ref());
  return state;
}

TEST(Extrapolation, IsAStraightLineAtTheNewestKnotsVelocityFollowedByAStop) {
  for (std::uint64_t seed = 1; seed < 20; ++seed) {
    const SlidingWindow window = walk(seed, 3);
    const Knot newest = window.knot(window.knots() - 1);
    Extrapolation extrapolation(3);
    extrapolation.begin(window);
    EXPECT_EQ(extrapolation.line_end(), newest.time + Extrapolation::kLineLength);
    EXPECT_EQ(extrapolation.rest(), extrapolation.line_end() + window.options().stop_length);
    for (const int ms : {0, 1, 100, 250}) {
      const State at = state_of(extrapolation, newest.time + milliseconds(ms), 3);
      for (std::size_t d = 0; d < 3; ++d) {
        EXPECT_NEAR(at.position()[d], newest.position[d] + ms * 1e-3 * newest.velocity[d], 1e-12);
        EXPECT_EQ(at.velocity()[d], newest.velocity[d]);
        EXPECT_EQ(at.acceleration()[d], 0);
      }
    }
    const std::vector<double> zeros(3);
    const State end = state_of(extrapolation, extrapolation.line_end(), 3);
    Segment stop(3);
    build_stop(extrapolation.line_end(), window.options().stop_length, end.position(),
               newest.velocity, zeros, stop);
    State wanted(3);
    for (const int ms : {1, 77, 249}) {
      evaluate(stop.order, stop.coefficients, ms * 1e-3, wanted.ref());
      const State at = state_of(extrapolation, stop.left + milliseconds(ms), 3);
      for (std::size_t d = 0; d < 3; ++d) {
        EXPECT_NEAR(at.position()[d], wanted.position()[d], 1e-12);
        EXPECT_NEAR(at.velocity()[d], wanted.velocity()[d], 1e-12);
        EXPECT_NEAR(at.acceleration()[d], wanted.acceleration()[d], 1e-10);
      }
    }
  }
}

TEST(Extrapolation, IsContinuousUpToItsAccelerationAndEndsAtRest) {
  const SlidingWindow window = walk(5, 2);
  Extrapolation extrapolation(2);
  extrapolation.begin(window);
  State before = state_of(extrapolation, window.time(window.knots() - 1), 2);
  const Time end = extrapolation.rest() + milliseconds(10);
  for (Time t = window.time(window.knots() - 1); t < end; t += Time(100'000)) {
    const State at = state_of(extrapolation, t, 2);
    for (std::size_t d = 0; d < 2; ++d) {
      const double speed = std::abs(window.knot(window.knots() - 1).velocity[d]);
      EXPECT_LE(std::abs(at.position()[d] - before.position()[d]), 1.01e-4 * speed + 1e-15);
      EXPECT_LE(std::abs(at.velocity()[d] - before.velocity()[d]), 1.01e-4 * 6 * speed);
      EXPECT_LE(std::abs(at.acceleration()[d] - before.acceleration()[d]), 1e-4 * 97 * speed);
    }
    before = at;
  }
  const State rest = state_of(extrapolation, extrapolation.rest(), 2);
  const State later = state_of(extrapolation, extrapolation.rest() + std::chrono::hours(1), 2);
  for (std::size_t d = 0; d < 2; ++d) {
    EXPECT_EQ(rest.velocity()[d], 0);
    EXPECT_EQ(rest.acceleration()[d], 0);
    EXPECT_EQ(later.velocity()[d], 0);
    EXPECT_EQ(later.acceleration()[d], 0);
    EXPECT_EQ(later.position()[d], rest.position()[d]);
  }
}

TEST(Extrapolation, UsesAtMostFourFifthsOfAVelocityLimitAndStopsWithinTheOthers) {
  for (std::uint64_t seed = 1; seed < 20; ++seed) {
    WindowOptions how{.stop_length = milliseconds(1)};
    how.limits = {.velocity = {3, 0}, .acceleration = {5, 7}, .jerk = {0, 200}};
    const SlidingWindow window = walk(seed, 2, how);
    const Knot newest = window.knot(window.knots() - 1);
    Extrapolation extrapolation(2);
    extrapolation.begin(window);
    const State line = state_of(extrapolation, newest.time, 2);
    EXPECT_NEAR(line.velocity()[0], std::clamp(newest.velocity[0], -2.4, 2.4), 1e-12);
    EXPECT_EQ(line.velocity()[1], newest.velocity[1]);
    const Time length = extrapolation.rest() - extrapolation.line_end();
    for (int i = 0; i <= 500; ++i) {
      const State at = state_of(extrapolation, extrapolation.line_end() + length * i / 500, 2);
      EXPECT_LE(std::abs(at.velocity()[0]), 2.4 * (1 + 1e-12));
      EXPECT_LE(std::abs(at.acceleration()[0]), 5 * (1 + 1e-6));
      EXPECT_LE(std::abs(at.acceleration()[1]), 7 * (1 + 1e-6));
    }
  }
}

TEST(Extrapolation, StartsFromTheNewestKnotAtEachBegin) {
  SlidingWindow window = walk(9, 1);
  Extrapolation extrapolation(1);
  extrapolation.begin(window);
  const double x = 3;
  const Time next = window.time(window.knots() - 1) + milliseconds(30);
  window.append({.time = next, .position = {&x, 1}});
  extrapolation.begin(window);
  EXPECT_EQ(extrapolation.line_end(), next + Extrapolation::kLineLength);
  EXPECT_EQ(state_of(extrapolation, next, 1).position()[0], 3);
}

}  // namespace
}  // namespace splinecast::core
