#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>
#include <random>
#include <vector>

#include "core/forms/stop.hpp"
#include "core/motion/trial.hpp"
#include "tests/fixtures/curves/mesh.hpp"

/// A copy of a window, changed and compared with limits.
namespace splinecast::core {
namespace {

using std::chrono::milliseconds;
using testing::Mesh;

Waypoint waypoint(const Mesh& mesh, std::size_t i) {
  return {.time = mesh.times[i], .position = mesh.position(i)};
}

SlidingWindow window_of(const Mesh& mesh, std::size_t knots, const WindowOptions& options,
                        bool is_later_run) {
  SlidingWindow window(mesh.dimensions, options);
  if (is_later_run) window.begin_run();
  for (std::size_t i = 0; i < knots; ++i) window.append(waypoint(mesh, i));
  return window;
}

class ATrial : public ::testing::TestWithParam<bool> {};

TEST_P(ATrial, GivesTheBitsThatTheWindowItselfWouldGive) {
  const Mesh mesh = testing::random_mesh(5, 60, 3, 4);
  const WindowOptions options{.limits = {.velocity = {1, 1, 1}}};
  Trial trial(3, options);
  Segment tried(3);
  Segment expected(3);
  for (std::size_t knots = 1; knots + 1 < mesh.size(); ++knots) {
    const SlidingWindow window = window_of(mesh, knots, options, GetParam());
    trial.begin(window);
    trial.window().append(waypoint(mesh, knots));
    const SlidingWindow longer = window_of(mesh, knots + 1, options, GetParam());
    ASSERT_EQ(trial.window().knots(), longer.knots());
    for (std::size_t i = longer.oldest_segment(); i < longer.knots(); ++i) {
      trial.window().segment(i, tried);
      longer.segment(i, expected);
      ASSERT_EQ(tried.left, expected.left);
      ASSERT_EQ(tried.right, expected.right);
      ASSERT_EQ(tried.coefficients, expected.coefficients) << knots << ' ' << i;
    }
  }
}
INSTANTIATE_TEST_SUITE_P(OfAFirstAndALaterRun, ATrial, ::testing::Bool());

/// The largest ratio of a segment from `first` on that exceeds a limit, and, with `unchanged`, of
/// those that keep the limits there.
double largest_ratio(const SlidingWindow& window, std::size_t first,
                     const SlidingWindow* unchanged) {
  const MotionLimits& limits = window.options().limits;
  double worst = 0;
  Segment segment(window.dimensions());
  for (std::size_t i = std::max(first, window.oldest_segment()); i + 1 < window.knots(); ++i) {
    if (unchanged != nullptr && i + 1 < unchanged->knots()) {
      unchanged->segment(i, segment);
      if (!keeps_within(limits, nullptr, segment)) continue;
    }
    window.segment(i, segment);
    if (keeps_within(limits, nullptr, segment)) continue;
    worst = std::max(worst, worst_excess(limits, nullptr, segment).ratio);
  }
  return worst;
}

TEST(Trial, FindsTheLargestExcessThatTheChangeMakes) {
  std::array<int, 3> found{};  // none, only with the change, also without it
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    const Mesh mesh = testing::random_mesh(seed, 20, 2, 3);
    const WindowOptions options{
        .limits = {.velocity = std::vector<double>(2, seed % 3 == 0 ? 1e4 : 150.0)}};
    const SlidingWindow window = window_of(mesh, 12, options, true);
    Trial trial(2, options);
    trial.begin(window);
    trial.window().append(waypoint(mesh, 12));
    for (const std::size_t first : {0U, 9U, 11U}) {
      const double all = largest_ratio(trial.window(), first, nullptr);
      const double only_new = largest_ratio(trial.window(), first, &window);
      const auto of_all = trial.worst_excess(first, nullptr);
      const auto of_new = trial.worst_excess(first, &window);
      ++found[of_new ? 1 : of_all ? 2 : 0];
      ASSERT_EQ(of_all ? of_all->excess.ratio : 0, all) << seed;
      ASSERT_EQ(of_new ? of_new->excess.ratio : 0, only_new) << seed;
      if (!of_new) continue;
      EXPECT_GE(of_new->time, window.time(std::max(first, trial.window().oldest_segment())));
      EXPECT_LE(of_new->time, mesh.times[12]);
      EXPECT_EQ(of_new->excess.kind, LimitKind::velocity);
    }
  }
  EXPECT_GT(found[0], 0);
  EXPECT_GT(found[1], 0);
  EXPECT_GT(found[2], 0);
}

TEST(Trial, LeavesTheWindowAsItIs) {
  const Mesh mesh = testing::random_mesh(7, 30, 2, 3);
  const WindowOptions options{.limits = {.acceleration = {5, 5}}};
  const SlidingWindow window = window_of(mesh, 20, options, false);
  const SlidingWindow same = window_of(mesh, 20, options, false);
  Trial trial(2, options);
  trial.begin(window);
  trial.window().finish({.kind = ConditionKind::halt, .value = {}});
  (void)trial.exceeds_no_more(options.limits, 0, window);
  Segment a(2);
  Segment b(2);
  for (std::size_t i = window.oldest_segment(); i < window.knots(); ++i) {
    window.segment(i, a);
    same.segment(i, b);
    EXPECT_EQ(a.coefficients, b.coefficients);
  }
  EXPECT_FALSE(window.finished());
}

TEST(Trial, OfAnUnchangedWindowExceedsNoMore) {
  const Mesh mesh = testing::random_mesh(9, 30, 2, 3);
  const WindowOptions options{.limits = {.velocity = {1e-3, 1e-3}}};
  const SlidingWindow window = window_of(mesh, 20, options, false);
  Trial trial(2, options);
  trial.begin(window);
  EXPECT_TRUE(trial.worst_excess(0, nullptr));
  EXPECT_FALSE(trial.worst_excess(0, &window));
  EXPECT_TRUE(trial.exceeds_no_more(options.limits, 0, window));
  trial.window().finish({.kind = ConditionKind::clamped, .value = {1e3, 1e3}});
  EXPECT_FALSE(trial.exceeds_no_more(options.limits, 0, window));
}

TEST(Trial, ComparesAStopWithAccelerationJerkAndBounds) {
  const MotionLimits limits{.acceleration = {10, 0}, .upper = {0.5, 0.5}};
  Trial trial(2, {.limits = limits});
  Segment stop(2);
  const auto stop_from = [&](std::vector<double> velocity, Time length) -> const Segment& {
    const std::vector<double> zeros(2);
    build_stop(milliseconds(1), length, zeros, velocity, zeros, stop);
    return stop;
  };
  EXPECT_FALSE(trial.excess_of_stop(stop_from({0.1, 0.1}, milliseconds(500))));
  const auto harsh = trial.excess_of_stop(stop_from({1, 0}, milliseconds(50)));
  ASSERT_TRUE(harsh);
  EXPECT_EQ(harsh->excess.kind, LimitKind::acceleration);
  EXPECT_EQ(harsh->excess.dimension, 0U);
  const auto far = trial.excess_of_stop(stop_from({0, 4}, milliseconds(900)));
  ASSERT_TRUE(far);
  EXPECT_EQ(far->excess.kind, LimitKind::position);
  EXPECT_EQ(far->excess.dimension, 1U);
  EXPECT_EQ(far->time, milliseconds(901));
  std::vector<double> scratch(2);  // dimension 1 has no limit of acceleration
  EXPECT_FALSE(excess_of_stop(trial.window(), stop, StopBounds::limited, scratch));
}

}  // namespace
}  // namespace splinecast::core
