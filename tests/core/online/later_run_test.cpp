#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string_view>
#include <vector>

#include "core/online/sliding_window.hpp"
#include "tests/fixtures/curves/mesh.hpp"

namespace splinecast::core {
namespace {

constexpr Time kMillisecond{1'000'000};

/// x(t) = 1 + 2t − 3t² and its derivatives; the second dimension has twice these values.
std::vector<double> parabola(Time t, int derivative) {
  const double s = to_seconds(t);
  const std::array<double, 3> x{1 + 2 * s - 3 * s * s, 2 - 6 * s, -6};
  const double value = x[static_cast<std::size_t>(derivative)];
  return {value, 2 * value};
}

/// A window in its second run.
struct LaterRun {
  SlidingWindow window;

  explicit LaterRun(WindowOptions how = {}) : window(2, std::move(how)) {
    const std::array far{100.0, -100.0};
    window.append({.time = -500 * kMillisecond, .position = far});
    window.append({.time = -400 * kMillisecond, .position = far});
    window.begin_run();
  }
  void append(Time t) {
    const auto position = parabola(t, 0);
    window.append({.time = t, .position = position});
  }
  [[nodiscard]] Segment segment(std::size_t i) const {
    Segment out(2);
    window.segment(i, out);
    return out;
  }
  [[nodiscard]] std::vector<double> first_velocity() const {
    const auto velocity = window.knot(0).velocity;
    return {velocity.begin(), velocity.end()};
  }
};

void expect_parabola(const Segment& segment, double tolerance) {
  State state(2);
  const double h = to_seconds(segment.right - segment.left);
  for (const double part : {0.0, 0.3, 1.0}) {
    evaluate(segment.order, segment.coefficients, part * h, state.ref());
    const Time t = segment.left + Time(std::llround(part * h * 1e9));
    for (int r = 0; r < 3; ++r) {
      const auto wanted = parabola(t, r);
      const auto got = r == 0 ? state.position() : r == 1 ? state.velocity() : state.acceleration();
      for (std::size_t d = 0; d < 2; ++d) EXPECT_NEAR(got[d], wanted[d], tolerance) << r;
    }
  }
}

void expect_near(const std::vector<double>& got, const std::vector<double>& wanted) {
  ASSERT_EQ(got.size(), wanted.size());
  for (std::size_t d = 0; d < got.size(); ++d) EXPECT_NEAR(got[d], wanted[d], 1e-10) << d;
}

TEST(LaterRun, ReproducesTheParabolaThroughItsWaypoints) {
  LaterRun run;
  for (const int t : {17, 30, 37, 50, 62, 70, 81, 99, 110}) run.append(t * kMillisecond);
  EXPECT_TRUE(run.window.is_later_run());
  EXPECT_EQ(run.window.knots(), 9U);
  EXPECT_EQ(run.window.segments(), 9U);
  EXPECT_EQ(run.segment(0).left, 17 * kMillisecond);
  for (std::size_t i = 0; i + 1 < run.window.segments(); ++i) expect_parabola(run.segment(i), 1e-8);
  EXPECT_EQ(run.segment(8).kind, SegmentKind::stop);
}

TEST(LaterRun, BeginsWithTheSlopeOfTheParabolaThroughItsFirstThreeWaypoints) {
  LaterRun run;
  for (const int t : {17, 30, 37}) run.append(t * kMillisecond);
  expect_near(run.first_velocity(), parabola(17 * kMillisecond, 1));
  // Later waypoints do not change it.
  const std::vector<double> third = run.first_velocity();
  const std::array far{7.0, -7.0};
  run.window.append({.time = 50 * kMillisecond, .position = far});
  EXPECT_EQ(run.first_velocity(), third);
}

TEST(LaterRun, OfOneWaypointBeginsAtRestAndOfTwoWithTheSlopeBetweenThem) {
  LaterRun run;
  run.append(17 * kMillisecond);
  EXPECT_EQ(run.first_velocity(), std::vector<double>(2));
  run.append(30 * kMillisecond);
  const auto x = parabola(17 * kMillisecond, 0);
  const auto y = parabola(30 * kMillisecond, 0);
  expect_near(run.first_velocity(), {(y[0] - x[0]) / 0.013, (y[1] - x[1]) / 0.013});
}

TEST(LaterRun, DoesNotDependOnTheRunBefore) {
  LaterRun run;
  SlidingWindow other(2, {});
  other.begin_run();
  for (int i = 0; i < 30; ++i) {
    const auto position = parabola((10 * i + 3 * (i % 3)) * kMillisecond, 0);
    const Waypoint waypoint{.time = (10 * i + 3 * (i % 3)) * kMillisecond, .position = position};
    run.window.append(waypoint);
    other.append(waypoint);
    for (std::size_t s = other.oldest_segment(); s < other.segments(); ++s) {
      Segment segment(2);
      other.segment(s, segment);
      EXPECT_EQ(run.segment(s).coefficients, segment.coefficients) << i << ' ' << s;
      EXPECT_EQ(run.segment(s).acceleration_step, segment.acceleration_step);
    }
  }
}

TEST(LaterRun, OfOneWaypointIsAHoldAfterTheFinish) {
  LaterRun run;
  run.append(17 * kMillisecond);
  run.window.finish({.kind = ConditionKind::natural, .value = {}});
  EXPECT_EQ(run.first_velocity(), std::vector<double>(2));
  EXPECT_EQ(run.segment(0).kind, SegmentKind::hold);
}

TEST(LaterRun, AnAppendChangesNoFrozenSegment) {
  for (const std::size_t settle : {0U, 1U, 8U}) {
    LaterRun run({.settle = settle});
    for (const int t : {17, 30, 37, 50}) run.append(t * kMillisecond);
    run.window.freeze(31 * kMillisecond);  // within the segment from 30 to 37
    std::vector<Segment> before;
    for (std::size_t i = 0; i < 2; ++i) before.push_back(run.segment(i));
    const std::vector<double> far{5, -5};
    run.window.append({.time = 60 * kMillisecond, .position = far});
    run.window.append({.time = 70 * kMillisecond, .position = far});
    for (std::size_t i = 0; i < 2; ++i) {
      EXPECT_EQ(run.segment(i).coefficients, before[i].coefficients) << settle << ' ' << i;
    }
    EXPECT_GE(run.window.settled_segments(), 2U);
  }
}

TEST(SlidingWindow, ChangesThawedKnotsAsIfTheyHadNeverBeenFrozen) {
  LaterRun frozen;
  LaterRun never;
  for (const int t : {17, 30, 37, 50}) {
    frozen.append(t * kMillisecond);
    never.append(t * kMillisecond);
  }
  frozen.window.freeze_knots(4);
  EXPECT_EQ(frozen.window.frozen_knots(), 4U);
  frozen.window.thaw_knots(1);
  EXPECT_EQ(frozen.window.frozen_knots(), 1U);
  never.window.freeze_knots(1);
  const std::vector<double> far{5, -5};
  frozen.window.append({.time = 60 * kMillisecond, .position = far});
  never.window.append({.time = 60 * kMillisecond, .position = far});
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_EQ(frozen.segment(i).coefficients, never.segment(i).coefficients) << i;
  }
  frozen.window.thaw_knots(3);  // freezes no knots
  EXPECT_EQ(frozen.window.frozen_knots(), 1U);
}

TEST(SlidingWindow, WritesTheAccelerationsAtItsKnots) {
  for (const auto* method : {"c2", "pchip", "akima", "smoothing"}) {
    WindowOptions how{.interpolant = {.method = find_method(method), .lambda = 1e-6}};
    how.settle = default_settle(*how.interpolant.method);
    SlidingWindow window(3, how);
    const testing::Mesh mesh = testing::random_mesh(11, 20, 3, 3);
    std::array<double, 3> acceleration{};
    Segment segment(3);
    State state(3);
    for (std::size_t n = 0; n < mesh.size(); ++n) {
      window.append({mesh.times[n], mesh.position(n), {}, {}});
      for (std::size_t i = window.oldest_segment(); i + 1 < window.knots(); ++i) {
        window.segment(i, segment);
        evaluate(segment.order, segment.coefficients, 0, state.ref());
        window.write_acceleration(i, acceleration);
        for (std::size_t d = 0; d < 3; ++d) {
          EXPECT_NEAR(acceleration[d], state.acceleration()[d], 1e-6) << method << n << ' ' << i;
        }
      }
      if (n == 0) continue;
      evaluate(segment.order, segment.coefficients, to_seconds(segment.right - segment.left),
               state.ref());
      window.write_acceleration(n, acceleration);
      for (std::size_t d = 0; d < 3; ++d) {
        EXPECT_NEAR(acceleration[d], state.acceleration()[d], 1e-6) << method << n;
      }
    }
  }
}

TEST(LaterRun, ContinuesBitForBitInARestoredWindow) {
  const std::vector<int> times{17, 30, 37, 50, 62, 70, 81, 99, 110, 120, 131, 140, 150};
  for (std::size_t cut = 0; cut < times.size(); ++cut) {
    LaterRun whole({.settle = 4});
    for (std::size_t i = 0; i < cut; ++i) whole.append(times[i] * kMillisecond);
    LaterRun next({.settle = 4});
    const std::size_t kept = std::min(cut, whole.window.knots_to_restore());
    std::vector<Knot> knots;
    for (std::size_t i = cut - kept; i < cut; ++i) knots.push_back(whole.window.knot(i));
    next.window.restore_run(cut - kept, knots);
    for (std::size_t i = cut; i < times.size(); ++i) {
      whole.append(times[i] * kMillisecond);
      next.append(times[i] * kMillisecond);
      for (std::size_t s = whole.window.oldest_segment(); s < whole.window.segments(); ++s) {
        if (cut > kept && s <= cut - kept) continue;
        EXPECT_EQ(whole.segment(s).coefficients, next.segment(s).coefficients) << cut << ' ' << s;
        EXPECT_EQ(whole.segment(s).acceleration_step, next.segment(s).acceleration_step);
      }
    }
  }
}

constexpr std::array kGiven{1.5, -0.5};
constexpr std::array kBent{3.0, 7.0};

/// A later run of a window whose start is a full stop.
LaterRun run_by(std::string_view method, WindowOptions how = {}) {
  how.interpolant = {.method = find_method(method), .lambda = 1e-6};
  how.settle = std::max(how.settle, default_settle(*how.interpolant.method));
  how.start = {.kind = ConditionKind::halt, .value = {}};
  LaterRun run(how);
  return run;
}

void append_given(SlidingWindow& window, Time t) {
  const auto x = parabola(t, 0);
  window.append({.time = t, .position = x, .velocity = kGiven, .acceleration = kBent});
}

TEST(LaterRun, KeepsTheDerivativesThatItsFirstWaypointGives) {
  for (const auto* method : {"hermite", "quintic"}) {
    WindowOptions how{.interpolant = {.method = find_method(method)}, .settle = 1};
    how.start = {.kind = ConditionKind::halt, .value = {}};
    SlidingWindow window(2, how);
    append_given(window, -10 * kMillisecond);
    window.begin_run();
    for (int i = 1; i <= 3; ++i) {
      append_given(window, 10 * i * kMillisecond);
      EXPECT_TRUE(std::ranges::equal(window.knot(0).velocity, kGiven)) << method << i;
      if (!how.interpolant.method->needs_acceleration()) continue;
      std::array<double, 2> acceleration{};
      window.write_acceleration(0, acceleration);
      EXPECT_TRUE(std::ranges::equal(acceleration, kBent)) << i;
    }
  }
}

TEST(LaterRun, CountsTheNewerKnotsThatShapedItsFirstKnot) {
  LaterRun run({.settle = 8});
  for (std::uint32_t i = 0; i < 12; ++i) {
    run.append(10 * (static_cast<int>(i) + 1) * kMillisecond);
    if (run.window.oldest_segment() > 0) break;
    EXPECT_EQ(run.window.newer_knots_seen(0), std::min(i, 8U));
  }
  // Without a lag a knot is final at once.
  LaterRun at_once({.settle = 0});
  at_once.append(10 * kMillisecond);
  const std::vector<double> first = at_once.first_velocity();
  at_once.append(20 * kMillisecond);
  EXPECT_EQ(at_once.first_velocity(), first);
  EXPECT_EQ(at_once.window.newer_knots_seen(0), 0U);
}

TEST(LaterRun, OfAnyMethodPassesThroughItsWaypoints) {
  for (const auto* method : {"c2", "pchip", "akima"}) {
    LaterRun run = run_by(method);
    for (int i = 1; i <= 6; ++i) run.append(10 * i * kMillisecond);
    State state(2);
    for (std::size_t i = run.window.oldest_segment(); i < run.window.segments(); ++i) {
      const Segment segment = run.segment(i);
      evaluate(segment.order, segment.coefficients, 0, state.ref());
      EXPECT_TRUE(std::ranges::equal(state.position(), parabola(segment.left, 0))) << method << i;
    }
  }
}

}  // namespace
}  // namespace splinecast::core
