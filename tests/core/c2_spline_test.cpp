#include "splinecast/core/c2_spline.hpp"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

#include "support/dense_spline.hpp"
#include "support/mesh.hpp"

namespace splinecast::core {
namespace {

using testing::Mesh;
using testing::query_times;
using testing::random_mesh;

PiecewisePolynomial spline(const Mesh& mesh, const Condition& start, const Condition& end) {
  return c2_spline(mesh.times, mesh.positions, mesh.dimensions, start, end);
}

Condition with_values(ConditionKind kind, std::uint64_t seed, std::size_t dimensions) {
  const bool takes = kind == ConditionKind::velocity || kind == ConditionKind::acceleration;
  return {kind, takes ? testing::random_values(seed, dimensions) : std::vector<double>{}};
}

constexpr ConditionKind kAllKinds[] = {ConditionKind::natural, ConditionKind::rest,
                                       ConditionKind::halt, ConditionKind::velocity,
                                       ConditionKind::acceleration};

TEST(C2Spline, InterpolatesIsC2AndAgreesWithADenseSolveForEveryPairingOfConditions) {
  for (const auto start_kind : kAllKinds) {
    for (const auto end_kind : kAllKinds) {
      const Mesh mesh = random_mesh(11, 30, 3, 10);
      const Condition start = with_values(start_kind, 1, 3);
      const Condition end = with_values(end_kind, 2, 3);
      const auto curve = spline(mesh, start, end);
      const auto wanted = testing::dense_velocities(mesh, start, end);
      const double scale = wanted.cwiseAbs().maxCoeff();
      State state(3);
      State before(3);
      std::vector<double> step(3);
      for (std::size_t i = 0; i < mesh.size(); ++i) {
        curve.evaluate(mesh.times[i], state.ref());
        for (std::size_t d = 0; d < 3; ++d) {
          EXPECT_NEAR(state.position()[d], mesh.position(i)[d], 1e-12);
          EXPECT_NEAR(state.velocity()[d],
                      wanted(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(d)),
                      1e-12 * scale);
        }
        if (i == 0 || i + 1 == mesh.size()) continue;
        const double h = to_seconds(mesh.times[i] - mesh.times[i - 1]);
        core::evaluate(curve.order_of(i - 1), curve.coefficients(i - 1), h, before.ref());
        curve.jump(i, 2, step);
        for (std::size_t d = 0; d < 3; ++d) {
          EXPECT_NEAR(before.acceleration()[d], state.acceleration()[d], 1e-6) << i;
          EXPECT_NEAR(step[d], 0, 1e-6) << i;
        }
      }
    }
  }
}

TEST(C2Spline, HaltsWithoutVelocityOrAccelerationAtBothEnds) {
  for (const std::size_t knots : {2U, 3U, 10U}) {
    const Mesh mesh = random_mesh(3, knots, 2, 3);
    const auto curve = spline(mesh, {ConditionKind::halt, {}}, {ConditionKind::halt, {}});
    State state(2);
    for (const Time t : {mesh.times.front(), mesh.times.back()}) {
      curve.evaluate(t, state.ref());
      for (std::size_t d = 0; d < 2; ++d) {
        EXPECT_NEAR(state.velocity()[d], 0, 1e-12);
        EXPECT_NEAR(state.acceleration()[d], 0, 1e-8);
      }
    }
  }
}

TEST(C2Spline, TwoNaturalWaypointsMakeALineAndOneMakesAHold) {
  const Mesh mesh = random_mesh(5, 2, 4, 1);
  const auto line = spline(mesh, {}, {});
  State state(4);
  for (const Time t : query_times(mesh, 4)) {
    line.evaluate(t, state.ref());
    for (std::size_t d = 0; d < 4; ++d) EXPECT_NEAR(state.acceleration()[d], 0, 1e-9);
  }
  const auto hold = spline(mesh.first(1), {}, {});
  hold.evaluate(mesh.times[0], state.ref());
  for (std::size_t d = 0; d < 4; ++d) {
    EXPECT_EQ(state.position()[d], mesh.position(0)[d]);
    EXPECT_EQ(state.velocity()[d], 0);
  }
}

TEST(C2Spline, ReproducesCubicsOnRandomMeshes) {
  EXPECT_TRUE(rc::check("cubics are reproduced", [](std::uint64_t seed) {
    Mesh mesh = random_mesh(seed, 3 + seed % 40, 2, 10);
    const auto c = testing::random_values(seed + 1, 8);
    const auto cubic = [&](double t, std::size_t d, int derivative) {
      const double a = c[4 * d];
      const double b = c[4 * d + 1];
      const double v = c[4 * d + 2];
      if (derivative == 2) return 6 * a * t + 2 * b;
      if (derivative == 1) return (3 * a * t + 2 * b) * t + v;
      return ((a * t + b) * t + v) * t + c[4 * d + 3];
    };
    for (std::size_t i = 0; i < mesh.size(); ++i) {
      for (std::size_t d = 0; d < 2; ++d) {
        mesh.positions[2 * i + d] = cubic(to_seconds(mesh.times[i]), d, 0);
      }
    }
    const double last = to_seconds(mesh.times.back());
    const auto curve =
        spline(mesh, {ConditionKind::velocity, {cubic(0, 0, 1), cubic(0, 1, 1)}},
               {ConditionKind::acceleration, {cubic(last, 0, 2), cubic(last, 1, 2)}});
    State state(2);
    double scale = 1;
    for (const double x : mesh.positions) scale = std::max(scale, std::abs(x));
    for (const Time t : query_times(mesh, 3)) {
      curve.evaluate(t, state.ref());
      for (std::size_t d = 0; d < 2; ++d) {
        RC_ASSERT(std::abs(state.position()[d] - cubic(to_seconds(t), d, 0)) < 1e-12 * scale);
        RC_ASSERT(std::abs(state.velocity()[d] - cubic(to_seconds(t), d, 1)) < 1e-9 * scale);
      }
    }
  }));
}

TEST(C2Spline, ShiftingTimeChangesNoBit) {
  const Mesh mesh = random_mesh(21, 50, 3, 5);
  Mesh shifted = mesh;
  const Time offset{1'700'000'000'000'000'000};
  for (Time& t : shifted.times) t += offset;
  const auto curve = spline(mesh, {}, {ConditionKind::halt, {}});
  const auto moved = spline(shifted, {}, {ConditionKind::halt, {}});
  State a(3);
  State b(3);
  for (const Time t : query_times(mesh, 7)) {
    curve.evaluate(t, a.ref());
    moved.evaluate(t + offset, b.ref());
    EXPECT_TRUE(std::ranges::equal(a.values(), b.values())) << t.count();
  }
}

TEST(C2Spline, NamesWhatIsWrongWithItsInput) {
  const std::vector<Time> times{Time(0), Time(10), Time(10)};
  const std::vector<double> positions{0, 1, 2};
  const auto message = [&](std::span<const Time> t, std::span<const double> x, std::size_t d) {
    try {
      (void)c2_spline(t, x, d, {}, {});
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_NE(message(times, positions, 1).find("waypoint 2, 10 ns"), std::string::npos);
  EXPECT_NE(message({}, {}, 1).find("at least one"), std::string::npos);
  EXPECT_NE(message(times, positions, 2).find("3 position values"), std::string::npos);
  EXPECT_NE(message(times, positions, 65).find("65"), std::string::npos);
  const std::vector<double> bad{0, std::numeric_limits<double>::infinity()};
  EXPECT_NE(message(std::span(times).first(2), bad, 1).find("waypoint 1, dimension 0"),
            std::string::npos);
}

}  // namespace
}  // namespace splinecast::core
