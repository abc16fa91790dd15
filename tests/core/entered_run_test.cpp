#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <vector>

#include "splinecast/core/limits.hpp"
#include "splinecast/core/sliding_window.hpp"
#include "support/mesh.hpp"

namespace splinecast::core {
namespace {

constexpr Time kMillisecond{1'000'000};

/// x(t) = 1 + 2t − 3t² and its derivatives; of the second dimension twice as much.
std::vector<double> parabola(Time t, int derivative) {
  const double s = to_seconds(t);
  const std::array<double, 3> x{1 + 2 * s - 3 * s * s, 2 - 6 * s, -6};
  const double value = x[static_cast<std::size_t>(derivative)];
  return {value, 2 * value};
}

struct Entered {
  std::vector<double> x, v, a;
  SlidingWindow window;

  explicit Entered(Time t, WindowOptions how = {}, std::span<const Time> before = {})
      : x(parabola(t, 0)), v(parabola(t, 1)), a(parabola(t, 2)), window(2, std::move(how)) {
    std::vector<std::vector<double>> positions;
    std::vector<StandingWaypoint> standing;
    for (const Time b : before) positions.push_back(parabola(b, 0));
    for (std::size_t i = 0; i < before.size(); ++i) standing.push_back({before[i], positions[i]});
    window.enter({t, x, v, a}, standing);
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

TEST(EnteredRun, IsThePolynomialThatStateAndWaypointsLieOn) {
  Entered run(5 * kMillisecond);
  for (const int t : {17, 30, 37, 50, 62, 70, 81, 99, 110}) run.append(t * kMillisecond);
  EXPECT_TRUE(run.window.is_entered());
  EXPECT_EQ(run.window.segments(), 10U);
  EXPECT_EQ(run.segment(0).kind, SegmentKind::splice);
  EXPECT_EQ(run.segment(0).left, 5 * kMillisecond);
  for (std::size_t i = 0; i + 1 < run.window.segments(); ++i) expect_parabola(run.segment(i), 1e-8);
}

TEST(EnteredRun, IsThePolynomialFromItsFirstWaypointOnIfTwoStandBefore) {
  const std::vector<Time> before{-9 * kMillisecond, 2 * kMillisecond};
  Entered run(5 * kMillisecond, {}, before);
  run.append(17 * kMillisecond);
  expect_parabola(run.segment(0), 1e-8);
  run.append(29 * kMillisecond);
  expect_parabola(run.segment(0), 1e-8);
  expect_parabola(run.segment(1), 1e-7);
}

TEST(EnteredRun, WithoutAWaypointIsAStopTailFromItsState) {
  Entered run(5 * kMillisecond);
  ASSERT_EQ(run.window.segments(), 1U);
  const Segment tail = run.segment(0);
  EXPECT_EQ(tail.kind, SegmentKind::stop_tail);
  State state(2);
  evaluate(tail.order, tail.coefficients, 0, state.ref());
  EXPECT_TRUE(std::ranges::equal(state.position(), run.x));
  EXPECT_TRUE(std::ranges::equal(state.velocity(), run.v));
}

TEST(EnteredRun, AnAppendLeavesEverythingFrozenAlone) {
  for (const std::size_t settle : {0U, 1U, 8U}) {
    Entered run(5 * kMillisecond, {.settle = settle});
    for (const int t : {17, 30, 37, 50}) run.append(t * kMillisecond);
    run.window.freeze(31 * kMillisecond);  // within the segment from 30 to 37
    std::vector<Segment> before;
    for (std::size_t i = 0; i < 3; ++i) before.push_back(run.segment(i));
    const std::vector<double> far{5, -5};
    run.window.append({.time = 60 * kMillisecond, .position = far});
    run.window.append({.time = 70 * kMillisecond, .position = far});
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_EQ(run.segment(i).coefficients, before[i].coefficients) << settle << ' ' << i;
    }
    EXPECT_GE(run.window.settled_segments(), 3U);
  }
}

TEST(EnteredRun, GoesOnBitForBitWhereAWindowStoodThatDied) {
  const std::vector<Time> before{-9 * kMillisecond, 2 * kMillisecond};
  const std::vector<int> times{17, 30, 37, 50, 62, 70, 81, 99, 110, 120, 131, 140, 150};
  for (std::size_t cut = 0; cut < times.size(); ++cut) {
    Entered whole(5 * kMillisecond, {.settle = 4}, before);
    for (std::size_t i = 0; i < cut; ++i) whole.append(times[i] * kMillisecond);
    Entered next(5 * kMillisecond, {.settle = 4}, before);
    const std::size_t kept = std::min(cut, whole.window.knots_to_restore());
    std::vector<Knot> knots;
    for (std::size_t i = cut - kept; i < cut; ++i) knots.push_back(whole.window.knot(i));
    std::vector<std::vector<double>> positions{parabola(before[0], 0), parabola(before[1], 0)};
    const std::vector<StandingWaypoint> standing{{before[0], positions[0]},
                                                 {before[1], positions[1]}};
    const RunEntry& entry = whole.window.entry();
    next.window.restore_entered(
        {.from = entry.state(), .before = standing, .acceleration = entry.acceleration()},
        cut - kept, knots);
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

TEST(EnteredRun, AWaypointThatNoSpliceReachesWithinTheLimitsIsNotTaken) {
  Entered run(5 * kMillisecond, {.limits = {.acceleration = {10, 20}}});
  const auto near = parabola(40 * kMillisecond, 0);
  const auto next = parabola(60 * kMillisecond, 0);
  const auto third = parabola(80 * kMillisecond, 0);
  std::vector<Waypoint> waypoints{{.time = 40 * kMillisecond, .position = near},
                                  {.time = 60 * kMillisecond, .position = next},
                                  {.time = 80 * kMillisecond, .position = third}};
  const std::vector<double> far{near[0] + 1, near[1]};
  const Waypoint off_the_way{.time = 40 * kMillisecond, .position = far};
  SlidingWindow trial(2, run.window.options());
  EXPECT_FALSE(run.window.can_append(std::span(&off_the_way, 1), trial));
  EXPECT_EQ(run.window.knots(), 0U);
  // The first one alone would be reached at rest, which is too hard; with those behind it it is
  // not.
  EXPECT_FALSE(run.window.can_append(std::span(waypoints).first(1), trial));
  EXPECT_EQ(run.window.segments(), 1U);
  EXPECT_EQ(run.segment(0).kind, SegmentKind::stop_tail);
}

constexpr std::array kGiven{1.5, -0.5};
constexpr std::array kBent{3.0, 7.0};

/// A window whose streams start from a halt, entered at the parabola's state.
Entered entered_by(std::string_view method, WindowOptions how = {}) {
  how.interpolant = {.method = find_method(method), .lambda = 1e-6};
  how.settle = std::max(how.settle, default_settle(*how.interpolant.method));
  how.start = {.kind = ConditionKind::halt, .value = {}};
  return Entered(Time(0), how);
}

void append_given(SlidingWindow& window, Time t) {
  const auto x = parabola(t, 0);
  window.append({.time = t, .position = x, .velocity = kGiven, .acceleration = kBent});
}

TEST(EnteredRun, KeepsTheVelocityThatItsFirstWaypointGives) {
  for (const auto* method : {"hermite", "quintic"}) {
    Entered run = entered_by(method, {.settle = 1});
    for (int i = 1; i <= 3; ++i) {
      append_given(run.window, 10 * i * kMillisecond);
      EXPECT_TRUE(std::ranges::equal(run.window.knot(0).velocity, kGiven)) << method << i;
    }
  }
}

TEST(EnteredRun, EndsItsSpliceWithTheAccelerationThatItsFirstWaypointGives) {
  Entered run = entered_by("quintic", {.settle = 1});
  append_given(run.window, 10 * kMillisecond);
  EXPECT_TRUE(std::ranges::equal(run.window.entry().acceleration(), kBent));
}

TEST(EnteredRun, SaysByHowManyKnotsItsSpliceWasShapedAlsoWithoutALag) {
  Entered run(Time(0), {.settle = 0});
  for (int i = 1; i <= 4; ++i) run.append(10 * i * kMillisecond);
  EXPECT_EQ(run.window.newer_knots_seen_by_entry(), 2U);
}

/// The bits of all that is kept of a window's knots.
std::vector<double> kept_of(const SlidingWindow& window) {
  std::vector<double> all;
  for (std::size_t i = 0; i < window.knots(); ++i) {
    const Knot knot = window.knot(i);
    all.push_back(knot.newer_knots);
    for (const auto values : {knot.position, knot.velocity, knot.acceleration, knot.residual}) {
      all.insert(all.end(), values.begin(), values.end());
    }
  }
  all.push_back(window.newer_knots_seen_by_entry());
  return all;
}

/// A waypoint that is tried for its accelerations leaves no trace, taken or refused.
void expect_no_trace(SlidingWindow& window, std::string_view what) {
  const std::vector<double> before = kept_of(window);
  const std::array far{1e6, -1e6};
  const std::array near{1.0, 2.0};
  std::vector<Waypoint> tried;
  for (int i = 0; i < 3; ++i) {
    tried.push_back({.time = (35 + 10 * i) * kMillisecond,
                     .position = i == 1 ? far : near,
                     .velocity = kGiven,
                     .acceleration = kBent});
  }
  SlidingWindow trial(2, window.options());
  (void)window.can_append(tried, trial);
  EXPECT_EQ(kept_of(window), before) << what;
}

TEST(SlidingWindow, GoesOnFromAnAssignedStateBitForBit) {
  constexpr std::array kBefore{-20 * kMillisecond, -10 * kMillisecond};
  for (const auto* method : {"c2", "hermite", "quintic", "pchip", "smoothing"}) {
    for (const std::size_t frozen : std::array<std::size_t, 3>{0, 1, 3}) {
      WindowOptions how =
          entered_by(method, {.settle = 1, .limits = {.acceleration = {10, 20}}}).window.options();
      Entered run(Time(0), how, kBefore);
      SlidingWindow assigned(2, how);
      append_given(assigned, 3 * kMillisecond);  // a state of its own, which goes
      for (int i = 1; i <= 6; ++i) {
        assigned.assign(run.window);
        EXPECT_EQ(kept_of(assigned), kept_of(run.window)) << method << i;
        append_given(assigned, 10 * i * kMillisecond);
        append_given(run.window, 10 * i * kMillisecond);
        EXPECT_EQ(kept_of(assigned), kept_of(run.window)) << method << i;
        assigned.freeze_knots(1);
        run.window.freeze_knots(frozen);
      }
      assigned.assign(run.window);
      EXPECT_EQ(assigned.frozen_knots(), run.window.frozen_knots());
      EXPECT_EQ(assigned.settled_segments(), run.window.settled_segments());
    }
  }
}

TEST(EnteredRun, IsAsItWasAfterAWaypointWasTried) {
  const std::vector<double> limits{1e5, 1e5};
  for (const auto* method : {"c2", "hermite", "quintic", "pchip", "smoothing"}) {
    Entered run = entered_by(method, {.settle = 1, .limits = {.acceleration = limits}});
    for (int i = 1; i <= 2; ++i) {
      append_given(run.window, 10 * i * kMillisecond);
      expect_no_trace(run.window, method);
    }
  }
  Entered run(Time(0), {.settle = 0, .limits = {.acceleration = limits}});
  run.append(10 * kMillisecond);
  run.append(20 * kMillisecond);
  expect_no_trace(run.window, "c2 without a lag");
}

TEST(FirstRun, OfOneKnotIsAsItWasAfterAWaypointWasTried) {
  for (const auto* method : {"c2", "hermite", "pchip", "smoothing"}) {
    WindowOptions how{.interpolant = {.method = find_method(method), .lambda = 1e-6},
                      .start = {.kind = ConditionKind::halt, .value = {}},
                      .limits = {.acceleration = {1e3, 1e3}}};
    how.settle = default_settle(*how.interpolant.method);
    SlidingWindow window(2, how);
    append_given(window, 10 * kMillisecond);
    expect_no_trace(window, method);
  }
}

}  // namespace
}  // namespace splinecast::core
