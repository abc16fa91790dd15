#include "core/batch/c2.hpp"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

#include "core/polynomial/segment.hpp"
#include "tests/fixtures/curves/dense_spline.hpp"
#include "tests/fixtures/curves/mesh.hpp"

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

constexpr ConditionKind kAllKinds[] = {ConditionKind::natural, ConditionKind::clamped,
                                       ConditionKind::halt, ConditionKind::velocity,
                                       ConditionKind::acceleration};

/// Largest value of each derivative.
std::array<double, 4> largest_values(const PiecewisePolynomial& curve, const Mesh& mesh) {
  std::array<double, 4> most{};
  State state(2);
  for (const Time t : query_times(mesh, 4)) {
    curve.evaluate(t, state.ref());
    for (std::size_t k = 0; k < 8; ++k) {
      most[k / 2] = std::max(most[k / 2], std::abs(state.values()[k]));
    }
  }
  return most;
}

void expect_forms_agree(const Mesh& mesh, const Condition& start, const Condition& end) {
  const Waypoints all{.dimensions = 2, .times = mesh.times, .positions = mesh.positions};
  const auto a = c2_spline(all, start, end, C2Form::velocity);
  const auto b = c2_spline(all, start, end, C2Form::acceleration);
  const auto scale = largest_values(a, mesh);
  State x(2);
  State y(2);
  for (const Time t : query_times(mesh, 4)) {
    a.evaluate(t, x.ref());
    b.evaluate(t, y.ref());
    for (std::size_t k = 0; k < 8; ++k) {
      ASSERT_NEAR(x.values()[k], y.values()[k], 1e-9 * scale[k / 2])
          << to_string(start) << " to " << to_string(end) << ", " << mesh.size() << " knots";
    }
  }
}

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

TEST(C2Spline, AFullStopHasNoVelocityAndNoAccelerationAtBothEnds) {
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

/// A mesh whose last position equals its first.
Mesh closed_mesh(std::uint64_t seed, std::size_t knots, double ratio) {
  Mesh mesh = random_mesh(seed, knots, 2, ratio);
  std::ranges::copy(mesh.first(1).positions, mesh.positions.end() - 2);
  return mesh;
}

TEST(C2Spline, BothFormsAgreeForEveryPairingOfConditions) {
  std::vector<ConditionKind> kinds(std::begin(kAllKinds), std::end(kAllKinds));
  kinds.push_back(ConditionKind::not_a_knot);
  for (const double ratio : {1.0, 10.0, 1000.0}) {
    for (const auto start_kind : kinds) {
      for (const auto end_kind : kinds) {
        for (const std::size_t knots : {4U, 5U, 40U}) {
          const Mesh mesh = random_mesh(knots, knots, 2, ratio);
          expect_forms_agree(mesh, with_values(start_kind, 1, 2), with_values(end_kind, 2, 2));
        }
      }
    }
    const Condition periodic{ConditionKind::periodic, {}};
    for (const std::size_t knots : {3U, 4U, 40U}) {
      expect_forms_agree(closed_mesh(knots, knots, ratio), periodic, periodic);
    }
  }
}

TEST(C2Spline, PeriodicJoinsPositionVelocityAndAcceleration) {
  for (const std::size_t knots : {3U, 4U, 5U, 40U}) {
    const Mesh mesh = closed_mesh(9, knots, 5);
    const Condition periodic{ConditionKind::periodic, {}};
    const auto curve = spline(mesh, periodic, periodic);
    State first(2);
    State last(2);
    State before(2);
    curve.evaluate(mesh.times.front(), first.ref());
    curve.evaluate(mesh.times.back(), last.ref());
    const auto scale = largest_values(curve, mesh);
    for (std::size_t k = 0; k < 6; ++k) {
      EXPECT_NEAR(first.values()[k], last.values()[k], 1e-11 * scale[k / 2]);
    }
    for (std::size_t i = 1; i + 1 < mesh.size(); ++i) {
      curve.evaluate(mesh.times[i], first.ref());
      const double h = to_seconds(mesh.times[i] - mesh.times[i - 1]);
      core::evaluate(curve.order_of(i - 1), curve.coefficients(i - 1), h, before.ref());
      EXPECT_NEAR(first.acceleration()[0], before.acceleration()[0], 1e-11 * scale[2]) << i;
    }
  }
}

TEST(C2Spline, NotAKnotHasOneCubicOverTheFirstAndLastTwoIntervals) {
  const Condition not_a_knot{ConditionKind::not_a_knot, {}};
  const Mesh mesh = random_mesh(12, 9, 2, 8);
  const auto curve = spline(mesh, not_a_knot, not_a_knot);
  const double scale = largest_values(curve, mesh)[3];
  for (const std::size_t knot : {std::size_t{1}, mesh.size() - 2}) {
    for (std::size_t d = 0; d < 2; ++d) {
      EXPECT_NEAR(curve.coefficients(knot - 1)[6 + d], curve.coefficients(knot)[6 + d],
                  1e-11 * scale);
    }
  }
}

TEST(C2Spline, RefusesInvalidPairingsOfConditions) {
  const Condition periodic{ConditionKind::periodic, {}};
  const Condition not_a_knot{ConditionKind::not_a_knot, {}};
  const auto reason = [](const Mesh& mesh, const Condition& start, const Condition& end) {
    try {
      (void)spline(mesh, start, end);
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  const Mesh closed = closed_mesh(1, 6, 2);
  const auto open = reason(random_mesh(1, 6, 2, 2), periodic, periodic);
  EXPECT_NE(open.find("last position equal"), std::string::npos) << open;
  EXPECT_NE(reason(closed, periodic, {}).find("not natural"), std::string::npos);
  EXPECT_NE(reason(closed, {}, periodic).find("not natural"), std::string::npos);
  EXPECT_NE(reason(closed_mesh(1, 2, 2), periodic, periodic).find("3 waypoints; there are 2"),
            std::string::npos);
  EXPECT_NE(reason(closed.first(3), not_a_knot, not_a_knot).find("4 waypoints; there are 3"),
            std::string::npos);
  EXPECT_NE(reason(closed.first(2), not_a_knot, {}).find("3 waypoints; there are 2"),
            std::string::npos);
  EXPECT_EQ(reason(closed.first(3), not_a_knot, {}), "");
  EXPECT_EQ(reason(closed.first(4), not_a_knot, not_a_knot), "");
}

TEST(C2Spline, ErrorsNameTheInvalidInput) {
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
  const std::vector<Time> far{Time::min(), Time(10)};
  EXPECT_NE(message(far, std::span(positions).first(2), 1).find("waypoint 0, -92233720368547758"),
            std::string::npos);
  EXPECT_NE(message({}, {}, 1).find("at least one"), std::string::npos);
  EXPECT_NE(message(times, positions, 2).find("3 position values"), std::string::npos);
  EXPECT_NE(message(times, positions, 65).find("65"), std::string::npos);
  const std::vector<double> bad{0, std::numeric_limits<double>::infinity()};
  EXPECT_NE(message(std::span(times).first(2), bad, 1).find("waypoint 1, dimension 0"),
            std::string::npos);
}

}  // namespace
}  // namespace splinecast::core
