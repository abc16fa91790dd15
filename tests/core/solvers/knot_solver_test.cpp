#include "core/solvers/knot_solver.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

namespace splinecast::core {
namespace {

/// A waypoint of an uneven mesh; some positions are 0 and some velocities are −0.
struct Given {
  std::vector<double> position, velocity, acceleration;
  Time time{};

  Given(std::size_t dimensions, int i) : time(10'000'000 * i + 1'234'567 * (i * i % 5)) {
    for (std::size_t d = 0; d < dimensions; ++d) {
      const double x = std::sin(0.7 * i + static_cast<double>(d));
      position.push_back(i % 7 == 3 ? 0.0 : x);
      velocity.push_back(i % 5 == 1 ? -0.0 : 3 * x);
      acceleration.push_back(-2 * x);
    }
  }
  [[nodiscard]] Waypoint waypoint() const {
    return {.time = time, .position = position, .velocity = velocity, .acceleration = acceleration};
  }
};

/// All values that are kept of a knot, with their sign bits: −0 differs from 0.
std::vector<double> kept(const KnotRing& knots, std::size_t i) {
  const Knot knot = knots.knot(i);
  std::vector<double> all{to_seconds(knot.time), knot.prefix.gamma, knots.row(i).h};
  for (const auto values : {knot.waypoint, knots.values(i, KnotRing::kChord), knot.velocity,
                            knots.values(i, KnotRing::kG), knot.acceleration, knot.residual}) {
    all.insert(all.end(), values.begin(), values.end());
  }
  const std::size_t count = all.size();
  for (std::size_t k = 0; k < count; ++k) all.push_back(std::signbit(all[k]) ? 1 : 0);
  return all;
}

TEST(KnotSolver, AppendGivesTheBitsOfPushAndSolve) {
  constexpr std::size_t kCapacity = 16;
  constexpr std::size_t kLag = 8;
  for (const auto* name : {"c2", "pchip", "hermite", "quintic", "smoothing"}) {
    const Interpolant how{.method = find_method(name), .lambda = 1e-6};
    for (const ConditionKind start : {ConditionKind::clamped, ConditionKind::natural}) {
      for (const Tail tail : {Tail::bessel, Tail::parabolic, Tail::natural, Tail::clamped}) {
        for (const std::size_t dimensions : {1U, 2U, 3U, 4U, 5U, 7U, 8U, 9U, 13U, 64U}) {
          const Condition condition{.kind = start, .value = {}};
          const auto solver = make_knot_solver(how, condition, dimensions, Use::online);
          KnotRing appended(dimensions, kCapacity, *how.method, false);
          KnotRing pushed(dimensions, kCapacity, *how.method, false);
          for (int i = 0; i < 40; ++i) {
            const Given given(dimensions, i);
            const std::size_t n = appended.size();
            const std::size_t last = n - std::min(n, kLag);
            solver->append(appended, given.waypoint(), tail, last);
            solver->push(pushed, given.waypoint());
            solver->solve(pushed, tail, last);
            for (std::size_t k = last; k <= n; ++k) {
              ASSERT_EQ(kept(appended, k), kept(pushed, k))
                  << name << ", " << to_string(tail) << ", dimensions " << dimensions << ", knot "
                  << k << " of " << n;
            }
          }
        }
      }
    }
  }
}

}  // namespace
}  // namespace splinecast::core
