#include "core/online/sliding_window.hpp"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <algorithm>
#include <stdexcept>
#include <vector>

#include "core/batch/c2.hpp"
#include "splinecast/piecewise_polynomial.hpp"
#include "tests/fixtures/curves/dense_spline.hpp"
#include "tests/fixtures/curves/mesh.hpp"
#include "tests/fixtures/curves/online.hpp"

namespace splinecast::core {
namespace {

using testing::Mesh;
using testing::query_times;
using testing::random_mesh;

constexpr Tail kTails[] = {Tail::bessel, Tail::parabolic, Tail::natural, Tail::clamped};

WindowOptions options(std::size_t settle, Tail tail, Condition start = {}) {
  return {.settle = settle, .tail = tail, .start = std::move(start), .stop_length = Time(1000)};
}

std::vector<Segment> online_segments(const Mesh& mesh, const WindowOptions& how,
                                     const Condition& end) {
  return testing::settled_segments(
      {.dimensions = mesh.dimensions, .times = mesh.times, .positions = mesh.positions}, how, end);
}

PiecewisePolynomial joined(const std::vector<Segment>& segments) {
  PiecewisePolynomial curve(segments.front().acceleration_step.size());
  for (const Segment& segment : segments) append(segment, curve);
  return curve;
}

PiecewisePolynomial online(const Mesh& mesh, const WindowOptions& how, const Condition& end) {
  return joined(online_segments(mesh, how, end));
}

TEST(SlidingWindow, AConvergedVelocityEqualsAFullSolveWithTheTailAtTheLastWaypoint) {
  for (const std::size_t settle : {0U, 1U, 4U, 8U, 16U}) {
    for (const Tail tail : kTails) {
      for (const std::uint64_t seed : {1U, 2U, 3U}) {
        const Mesh mesh = random_mesh(seed, 60, 2, 10);
        SlidingWindow window(2, options(settle, tail));
        const double scale = testing::dense_velocities(mesh, {}, Condition{}).cwiseAbs().maxCoeff();
        for (std::size_t n = 0; n < mesh.size(); ++n) {
          window.append({mesh.times[n], mesh.position(n)});
          if (n < settle || n < 1) continue;
          const std::size_t converged = n - settle;
          const auto full = testing::dense_velocities(mesh.first(n + 1), {}, tail);
          const auto v = window.knot(converged).velocity;
          for (std::size_t d = 0; d < 2; ++d) {
            ASSERT_NEAR(v[d],
                        full(static_cast<Eigen::Index>(converged), static_cast<Eigen::Index>(d)),
                        1e-12 * scale)
                << "K " << settle << ", seed " << seed << ", knot " << converged;
          }
        }
      }
    }
  }
}

TEST(SlidingWindow, NoAppendChangesASettledSegment) {
  for (const std::size_t settle : {0U, 1U, 2U, 8U}) {
    const Mesh mesh = random_mesh(4, 40, 3, 10);
    SlidingWindow window(3, options(settle, Tail::bessel));
    std::vector<Segment> first_seen;
    Segment segment(3);
    for (std::size_t n = 0; n < mesh.size(); ++n) {
      window.append({mesh.times[n], mesh.position(n)});
      ASSERT_LE(window.oldest_segment(), first_seen.size());
      for (std::size_t i = window.oldest_segment(); i < window.settled_segments(); ++i) {
        window.segment(i, segment);
        if (i == first_seen.size()) first_seen.push_back(segment);
        EXPECT_EQ(first_seen[i].coefficients, segment.coefficients);
        EXPECT_EQ(first_seen[i].acceleration_step, segment.acceleration_step);
      }
    }
  }
}

TEST(SlidingWindow, WithALongLagEqualsTheBatchSolveInPositionVelocityAndAcceleration) {
  const Condition halt{ConditionKind::halt, {}};
  const Condition natural{};
  for (const auto& [start, end] :
       {std::pair(natural, natural), std::pair(halt, halt), std::pair(natural, halt)}) {
    const Mesh mesh = random_mesh(6, 200, 2, 3);
    const auto got = online(mesh, options(48, Tail::bessel, start), end);
    const auto wanted = c2_spline(mesh.times, mesh.positions, 2, start, end);
    double scale[3] = {0, 0, 0};
    double error[3] = {0, 0, 0};
    State a(2);
    State b(2);
    for (const Time t : query_times(mesh, 5)) {
      got.evaluate(t, a.ref());
      wanted.evaluate(t, b.ref());
      for (std::size_t k = 0; k < 6; ++k) {
        scale[k / 2] = std::max(scale[k / 2], std::abs(b.values()[k]));
        error[k / 2] = std::max(error[k / 2], std::abs(a.values()[k] - b.values()[k]));
      }
    }
    for (int k = 0; k < 3; ++k) EXPECT_LE(error[k], 1e-12 * scale[k]) << "derivative " << k;
  }
}

TEST(SlidingWindow, PositionAndVelocityNeverStepAndEachSegmentCarriesItsAccelerationStep) {
  EXPECT_TRUE(rc::check("joins", [](std::uint64_t seed) {
    const std::size_t settle = seed % 9;
    const Mesh mesh = random_mesh(seed, 2 + seed % 50, 2, 10);
    const auto segments =
        online_segments(mesh, options(settle, kTails[seed % 4], {ConditionKind::halt, {}}),
                        {ConditionKind::halt, {}});
    const auto curve = joined(segments);
    double accelerations = 1;
    State state(2);
    for (const Time t : query_times(mesh, 4)) {
      curve.evaluate(t, state.ref());
      for (const double a : state.acceleration())
        accelerations = std::max(accelerations, std::abs(a));
    }
    State before(2);
    for (std::size_t i = 1; i < curve.segments(); ++i) {
      core::evaluate(curve.order_of(i - 1), curve.coefficients(i - 1),
                     to_seconds(mesh.times[i] - mesh.times[i - 1]), before.ref());
      curve.evaluate(mesh.times[i], state.ref());
      for (std::size_t d = 0; d < 2; ++d) {
        RC_ASSERT(std::abs(state.position()[d] - before.position()[d]) < 1e-11);
        RC_ASSERT(std::abs(state.velocity()[d] - before.velocity()[d]) < 1e-8);
        const double step = state.acceleration()[d] - before.acceleration()[d];
        RC_ASSERT(std::abs(step - segments[i].acceleration_step[d]) < 1e-8 * accelerations);
      }
    }
  }));
}

TEST(SlidingWindow, TheNewestSegmentComesToRestWhileTheStreamRuns) {
  const Mesh mesh = random_mesh(8, 20, 2, 2);
  SlidingWindow window(2, {.settle = 4, .stop_length = Time(300'000'000)});
  Segment segment(2);
  State state(2);
  for (std::size_t n = 0; n < mesh.size(); ++n) {
    window.append({mesh.times[n], mesh.position(n)});
    ASSERT_EQ(window.segments(), n + 1);
    window.segment(n, segment);
    EXPECT_EQ(segment.kind, SegmentKind::stop);
    EXPECT_EQ(segment.left, mesh.times[n]);
    core::evaluate(segment.order, segment.coefficients, 0.3, state.ref());
    for (std::size_t d = 0; d < 2; ++d) {
      EXPECT_NEAR(state.velocity()[d], 0, 1e-9);
      EXPECT_NEAR(state.acceleration()[d], 0, 1e-7);
    }
  }
}

TEST(SlidingWindow, OneWaypointIsAHoldBeforeAndAfterTheFinish) {
  SlidingWindow window(2, {});
  const std::vector<double> x{1.5, -2};
  window.append({Time(77), x});
  Segment segment(2);
  State state(2);
  for (const SegmentKind kind : {SegmentKind::stop, SegmentKind::hold}) {
    ASSERT_EQ(window.segments(), 1U);
    window.segment(0, segment);
    EXPECT_EQ(segment.kind, kind);
    core::evaluate(segment.order, segment.coefficients, 0.1, state.ref());
    EXPECT_TRUE(std::ranges::equal(state.position(), x));
    EXPECT_EQ(state.velocity()[0], 0);
    window.finish({ConditionKind::halt, {}});
  }
}

TEST(SlidingWindow, AFinishKeepsItsConditionAtAnyLag) {
  for (const std::size_t settle : {0U, 1U, 2U, 8U, 64U}) {
    const Mesh mesh = random_mesh(9, 12, 1, 3);
    const auto curve = online(mesh, options(settle, Tail::bessel), {ConditionKind::halt, {}});
    State state(1);
    curve.evaluate(mesh.times.back(), state.ref());
    EXPECT_NEAR(state.velocity()[0], 0, 1e-11) << settle;
    EXPECT_NEAR(state.acceleration()[0], 0, 1e-7) << settle;
  }
}

TEST(SlidingWindow, ARestoredWindowContinuesBitForBit) {
  for (const std::size_t settle : {0U, 1U, 8U}) {
    for (std::size_t cut = 1; cut < 24; ++cut) {
      const Mesh mesh = random_mesh(10, 24, 2, 4);
      SlidingWindow whole(2, options(settle, Tail::bessel));
      for (std::size_t n = 0; n < cut; ++n) whole.append({mesh.times[n], mesh.position(n)});
      SlidingWindow resumed(2, options(settle, Tail::bessel));
      const std::size_t first = cut - std::min(cut, whole.knots_to_restore());
      std::vector<Knot> knots;
      for (std::size_t i = first; i < cut; ++i) knots.push_back(whole.knot(i));
      resumed.restore(first, knots);
      Segment a(2);
      Segment b(2);
      for (std::size_t n = cut; n < mesh.size(); ++n) {
        whole.append({mesh.times[n], mesh.position(n)});
        resumed.append({mesh.times[n], mesh.position(n)});
        for (std::size_t i = whole.oldest_segment(); i < whole.segments(); ++i) {
          whole.segment(i, a);
          resumed.segment(i, b);
          ASSERT_EQ(a.coefficients, b.coefficients) << "cut " << cut << ", segment " << i;
          ASSERT_EQ(a.acceleration_step, b.acceleration_step);
        }
      }
    }
  }
}

TEST(SlidingWindow, RefusesOptionsOutOfRange) {
  EXPECT_THROW(SlidingWindow(0, {}), std::invalid_argument);
  EXPECT_THROW(SlidingWindow(65, {}), std::invalid_argument);
  EXPECT_THROW(SlidingWindow(1, options(65, Tail::clamped)), std::invalid_argument);
  EXPECT_THROW(SlidingWindow(1, {.stop_length = Time(0)}), std::invalid_argument);
  EXPECT_THROW(SlidingWindow(2, options(8, Tail::clamped, {ConditionKind::velocity, {1}})),
               std::invalid_argument);
}

}  // namespace
}  // namespace splinecast::core
