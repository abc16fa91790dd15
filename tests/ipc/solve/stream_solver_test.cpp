#include "ipc/solve/stream_solver.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "ipc/sampling/sampler.hpp"
#include "splinecast/piecewise_polynomial.hpp"
#include "tests/fixtures/curves/mesh.hpp"
#include "tests/fixtures/curves/online.hpp"
#include "tests/fixtures/streams/memory_stream.hpp"

namespace splinecast::ipc {
namespace {

using testing::MemoryStream;
using testing::Mesh;
using testing::random_mesh;

/// The segments of a window that gets the waypoints directly.
PiecewisePolynomial direct(const Mesh& mesh, const core::WindowOptions& how, const Condition& end) {
  return testing::online(
      {.dimensions = mesh.dimensions, .times = mesh.times, .positions = mesh.positions}, how, end);
}

void expect_same_bits(MemoryStream& stream, const Mesh& mesh, const PiecewisePolynomial& wanted) {
  Sampler sampler(stream.board.reader, StreamClock::recorded);
  State a(mesh.dimensions);
  State b(mesh.dimensions);
  for (const Time t : testing::query_times(mesh, 3)) {
    ASSERT_EQ(sampler.sample(t, a.ref()), SampleStatus::settled) << t.count();
    wanted.evaluate(t, b.ref());
    ASSERT_TRUE(std::ranges::equal(a.values(), b.values())) << t.count();
  }
}

TEST(StreamSolver, PublishesTheBitsOfTheWindowForAnyBatchSize) {
  for (const std::size_t settle : {0U, 1U, 8U}) {
    const core::WindowOptions how{.settle = settle};
    const Mesh mesh = random_mesh(settle + 1, 300, 3, 5);
    const Condition halt{ConditionKind::halt, {}};
    const auto wanted = direct(mesh, how, halt);
    for (const std::size_t batch : {1U, 7U, 300U}) {
      MemoryStream stream(3, how);
      for (std::size_t i = 0; i < mesh.size(); i += batch) {
        stream.send(mesh, i, std::min(mesh.size(), i + batch));
        stream.drain();
      }
      stream.finish(halt);
      EXPECT_TRUE(stream.solver.summary().finished);
      EXPECT_EQ(stream.solver.summary().knots, mesh.size());
      expect_same_bits(stream, mesh, wanted);
    }
  }
}

TEST(StreamSolver, ASolverThatTakesOverContinuesBitForBitAfterADeathAtAnyKnot) {
  const core::WindowOptions how{.settle = 8};
  const Mesh mesh = random_mesh(3, 60, 2, 5);
  const auto wanted = direct(mesh, how, {});
  for (std::size_t cut = 0; cut <= mesh.size(); cut += 3) {
    MemoryStream stream(2, how);
    stream.send(mesh, 0, cut);
    stream.drain();
    stream.replace_solver();
    EXPECT_EQ(stream.solver.summary().knots, cut);
    stream.send(mesh, cut, mesh.size());
    stream.finish();
    expect_same_bits(stream, mesh, wanted);
  }
}

TEST(StreamSolver, RefusesInvalidIntervalsWithReasonAndItemNumber) {
  MemoryStream stream(1, {}, 64, 64, {.least = Time(5000), .most = Time(1'000'000)});
  const auto put = [&](std::int64_t t, double x) {
    const std::vector<double> position{x};
    ASSERT_EQ(stream.append(Time(t), position), AppendStatus::accepted);
  };
  put(10'000, 1);
  put(12'000, 2);  // closer than the solver accepts
  put(20'000, 3);
  put(2'000'000, 4);  // farther
  put(2'005'000, 5);  // too far from the last interpolated one
  stream.finish();
  const Summary& summary = stream.solver.summary();
  EXPECT_EQ(summary.knots, 2U);
  EXPECT_EQ(summary.refused, 3U);
  EXPECT_EQ(summary.reasons[static_cast<std::size_t>(Refusal::too_close)], 1U);
  EXPECT_EQ(summary.reasons[static_cast<std::size_t>(Refusal::too_far_apart)], 2U);
  EXPECT_EQ(stream.board.reader.refusal(0).item, 1U);
  EXPECT_EQ(stream.board.reader.refusal(2).item, 4U);
  EXPECT_EQ(summary.consumed, 6U);
}

TEST(StreamSolver, ReportsTheConsumedItemsAndFromWhenTheCurveChanged) {
  const Mesh mesh = random_mesh(4, 40, 1, 2);
  MemoryStream stream(1, {.settle = 4});
  for (std::size_t i = 0; i < mesh.size(); ++i) {
    stream.send(mesh, i, i + 1);
    stream.clock.time = Time(static_cast<std::int64_t>(i));
    const auto result = stream.solver.step(stream.clock);
    EXPECT_EQ(result.consumed, 1U);
    Summary summary;
    ASSERT_TRUE(stream.board.reader.copy_summary(stream.board.reader.look(), summary));
    EXPECT_EQ(summary.revision, i + 1);
    EXPECT_EQ(summary.consumed, i + 1);
    EXPECT_EQ(stream.board.reader.consumed(), i + 1);
    EXPECT_EQ(summary.newest, i + 1);
    EXPECT_EQ(summary.newest_time, mesh.times[i]);
    EXPECT_EQ(summary.changed_from, mesh.times[i >= 5 ? i - 5 : 0]);
    EXPECT_EQ(summary.settled_until, mesh.times[i >= 4 ? i - 4 : 0]);
    EXPECT_EQ(summary.committed, stream.clock.time);
  }
  EXPECT_FALSE(stream.solver.step(stream.clock).published);
}

TEST(StreamSolver, DoesNotReportNegativeTimesAsSettledTooEarly) {
  MemoryStream stream(1, {.settle = 4});
  Sampler sampler(stream.board.reader, StreamClock::recorded);
  State state(1);
  EXPECT_EQ(sampler.settled_until(), -kLatestTime);
  const auto put = [&](std::int64_t i) {
    const double x = i % 2 == 0 ? 0 : 1;
    ASSERT_EQ(stream.append(Time((i - 100) * 1'000'000), {&x, 1}), AppendStatus::accepted);
    stream.drain();
  };
  for (std::int64_t i = 0; i < 3; ++i) put(i);
  stream.replace_solver();  // must not report more as settled than its predecessor
  for (std::int64_t i = 3; i < 10; ++i) put(i);
  EXPECT_EQ(sampler.sample(Time(-95'500'000), state.ref()), SampleStatus::settled);
  EXPECT_EQ(sampler.sample(Time(-91'500'000), state.ref()), SampleStatus::provisional);
  EXPECT_EQ(sampler.settled_until(), Time(-95'000'000));
  stream.finish();
  EXPECT_EQ(sampler.sample(Time(-91'500'000), state.ref()), SampleStatus::settled);
}

TEST(StreamSolver, KeepsAsMuchHistoryAsTheBoardHolds) {
  const Mesh mesh = random_mesh(5, 500, 1, 2);
  MemoryStream stream(1, {}, 64, 64);
  stream.send(mesh, 0, mesh.size());
  stream.finish();
  const Summary& summary = stream.solver.summary();
  EXPECT_EQ(summary.newest, 500U);
  EXPECT_EQ(summary.newest - summary.first + 1, 64U);  // 64 knots, 63 segments
  Sampler sampler(stream.board.reader, StreamClock::recorded);
  State state(1);
  EXPECT_EQ(sampler.sample(mesh.times[500 - 64] - Time(1), state.ref()),
            SampleStatus::before_history);
  EXPECT_EQ(sampler.sample(mesh.times[500 - 64], state.ref()), SampleStatus::settled);
}

TEST(StreamSolver, AFinishDoesNotRestoreSegmentsThatTheBoardHasLost) {
  for (const bool takes_over : {false, true}) {
    const Mesh mesh = random_mesh(7, 300, 1, 2);
    MemoryStream stream(1, {}, 64, 32);
    stream.send(mesh, 0, mesh.size());
    stream.drain();
    EXPECT_EQ(stream.solver.summary().first, 269U);
    if (takes_over) stream.replace_solver();
    stream.finish();
    EXPECT_EQ(stream.solver.summary().newest, 300U);
    EXPECT_EQ(stream.solver.summary().first, 269U);
    Sampler sampler(stream.board.reader, StreamClock::recorded);
    State state(1);
    EXPECT_EQ(sampler.sample(Time(0), state.ref()), SampleStatus::before_history);
    EXPECT_EQ(sampler.sample(mesh.times[268] - Time(1), state.ref()), SampleStatus::before_history);
    EXPECT_EQ(sampler.sample(mesh.times[268], state.ref()), SampleStatus::settled);
    BoardSnapshot snapshot(1);
    EXPECT_EQ(sampler.snapshot(mesh.times[268], mesh.times[299], snapshot), SampleStatus::settled);
    EXPECT_EQ(snapshot.segments().size(), 31U);
  }
}

TEST(StreamSolver, AFinishWithoutWaypointsEndsAStreamWithoutData) {
  MemoryStream stream(1);
  stream.finish();
  EXPECT_TRUE(stream.solver.summary().finished);
  Sampler sampler(stream.board.reader, StreamClock::recorded);
  State state(1);
  EXPECT_EQ(sampler.sample(Time(0), state.ref()), SampleStatus::no_data);
}

TEST(StreamSolver, RefusesABoardTooSmallForItsLag) {
  EXPECT_THROW(MemoryStream(1, {.settle = 64}, 64, 64), std::invalid_argument);
}

}  // namespace
}  // namespace splinecast::ipc
