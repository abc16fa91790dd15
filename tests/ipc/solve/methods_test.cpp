#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "ipc/sampling/sampler.hpp"
#include "splinecast/fit.hpp"
#include "tests/fixtures/curves/method_trial.hpp"
#include "tests/fixtures/curves/online.hpp"
#include "tests/fixtures/curves/streaming_methods.hpp"
#include "tests/fixtures/streams/memory_stream.hpp"

// Every online method, through ring and board.
namespace splinecast::ipc {
namespace {

using testing::MemoryStream;
using testing::Trial;

class MethodsThroughRegions : public ::testing::TestWithParam<const Method*> {
 protected:
  [[nodiscard]] static core::WindowOptions options() { return testing::plain_window(*GetParam()); }

  /// Expects every sample of a finished stream to have the bits of the curve `wanted`.
  static void expect_same_bits(MemoryStream& stream, const Trial& trial,
                               const PiecewisePolynomial& wanted) {
    Sampler sampler(stream.board.reader, StreamClock::recorded);
    State got(2);
    State want(2);
    for (const Time t : testing::query_times(trial.mesh, 3)) {
      ASSERT_EQ(sampler.sample(t, got.ref()), SampleStatus::settled) << t.count();
      wanted.evaluate(t, want.ref());
      ASSERT_TRUE(std::ranges::equal(got.values(), want.values())) << t.count();
    }
  }
};

TEST_P(MethodsThroughRegions, EqualTheWindowBitForBitAndIfLocalTheBatch) {
  for (const ConditionKind kind : {ConditionKind::own, ConditionKind::halt}) {
    const Condition end{kind, {}};
    core::WindowOptions how = options();
    how.start = end;
    const Trial trial = testing::random_trial(7, 300, 2, 6);
    MemoryStream stream(2, how);
    for (std::size_t i = 0; i < trial.mesh.size(); ++i) stream.send(trial.waypoints()[i]);
    stream.finish(end);
    expect_same_bits(stream, trial, testing::online(trial.waypoints(), how, end));
    if (GetParam()->converges()) continue;
    FitOptions at_once = testing::plain_options(*GetParam());
    at_once.start = end;
    at_once.end = end;
    expect_same_bits(stream, trial, fit(trial.waypoints(), at_once));
  }
}

TEST_P(MethodsThroughRegions, AreTakenOverBitForBit) {
  const Condition own{ConditionKind::own, {}};
  const Trial trial = testing::random_trial(8, 200, 2, 4);
  const auto wanted = testing::online(trial.waypoints(), options(), own);
  for (const std::size_t every : {1U, 2U, 7U, 66U}) {
    MemoryStream stream(2, options());
    for (std::size_t i = 0; i < trial.mesh.size(); ++i) {
      stream.send(trial.waypoints()[i]);
      if (i % 3 == 0) stream.drain();
      if (i % every == 0) stream.replace_solver();
    }
    stream.finish(own);
    expect_same_bits(stream, trial, wanted);
  }
}

TEST_P(MethodsThroughRegions, RefuseWaypointsWithoutTheDerivativesTheyNeed) {
  const Trial trial = testing::random_trial(9, 3, 2, 1);
  MemoryStream stream(2, options());
  for (std::size_t i = 0; i < 3; ++i) {
    stream.send({.time = trial.mesh.times[i], .position = trial.mesh.position(i)});
  }
  stream.finish({ConditionKind::own, {}});
  const bool lacks = GetParam()->needs_velocity();
  EXPECT_EQ(stream.solver.summary().knots, lacks ? 0U : 3U);
  EXPECT_EQ(stream.solver.summary().reasons[static_cast<std::size_t>(Refusal::lacks_derivatives)],
            lacks ? 3U : 0U);
}

INSTANTIATE_TEST_SUITE_P(Every, MethodsThroughRegions,
                         ::testing::ValuesIn(testing::streaming_methods()),
                         [](const auto& tested) { return std::string(tested.param->name); });

TEST(StreamSolver, RefusesWaypointsTooCloseForItsLagAndLambda) {
  core::WindowOptions how{.interpolant = {.method = find_method("smoothing"), .lambda = 1e-5},
                          .settle = 20};
  MemoryStream stream(1, how);  // λ/h³ = 10 at 10 ms needs a lag of 24
  const double x = 0;
  for (int i = 0; i < 30; ++i) stream.send({.time = Time(i * 10'000'000), .position = {&x, 1}});
  stream.finish({ConditionKind::own, {}});
  const Summary& summary = stream.solver.summary();
  EXPECT_EQ(summary.knots + summary.refused, 30U);
  EXPECT_GT(summary.reasons[static_cast<std::size_t>(Refusal::lag_too_short)], 0U);
  EXPECT_GE(summary.knots, 20U);
}

}  // namespace
}  // namespace splinecast::ipc
