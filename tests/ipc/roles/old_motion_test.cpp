#include "ipc/owned/old_motion.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <vector>

#include "ipc/roles/internals.hpp"
#include "ipc/sweep/many_streams.hpp"
#include "splinecast/errors.hpp"
#include "splinecast/producer.hpp"
#include "splinecast/reader.hpp"
#include "splinecast/solver.hpp"
#include "tests/fixtures/processes/process.hpp"
#include "tests/fixtures/streams/memory_stream.hpp"

/// A live stream is recreated while readers still follow its old curve. Uses real regions and a
/// clock that the test sets.
namespace splinecast::ipc {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr Condition kHalt{.kind = ConditionKind::halt, .value = {}};

class OldMotion : public ::testing::Test {
 protected:
  static AppendStatus append(Producer& producer, Time t, double x) {
    return producer.append({.time = t, .position = {&x, 1}});
  }

  /// Sends eleven waypoints, 100 ms apart, of a motion that ends at 2 s.
  void send_first(Producer& producer) {
    for (int i = 0; i <= 10; ++i) {
      const double x = std::sin(0.5 * i);
      ASSERT_EQ(append(producer, seconds(1) + i * milliseconds(100), x), AppendStatus::accepted);
    }
  }

  [[nodiscard]] static bool finished(const Reader& reader) {
    Summary summary;
    return Internals::summary(reader, summary) && summary.finished;
  }

  testing::TestStream stream_;
  testing::FixedClock clock_;
  ProducerOptions options_{.dimensions = 1, .horizon = Time::max()};
};

/// A controller that leaves a retired board must find the motion that the solver then executes,
/// although the producer of that motion has been followed by another one meanwhile.
TEST_F(OldMotion, IsFoundByAReaderThatAttachesWhileANewerStreamWaitsForItsEnd) {
  clock_.time = MonotonicClock().now();
  Solver solver(stream_.name(), {});
  std::optional<Producer> producer(std::in_place, stream_.name(), options_);
  ASSERT_TRUE(solver.attach(clock_));
  const Time first = clock_.time + seconds(100);
  for (int i = 0; i <= 10; ++i) {
    ASSERT_EQ(append(*producer, first + i * milliseconds(100), i), AppendStatus::accepted);
  }
  ASSERT_EQ(producer->finish(kHalt), AppendStatus::accepted);
  solver.step(clock_);
  const std::uint64_t moving = producer->stream_id();
  producer.reset();
  producer.emplace(stream_.name(), options_);
  ASSERT_NE(producer->stream_id(), moving);
  Reader reader(stream_.name());
  EXPECT_EQ(Internals::header(reader).stream_id, moving);
  State state(1);
  EXPECT_TRUE(has_values(reader.preview(first + milliseconds(500), state)));
  // At rest it is not found any more: the newer stream's board is about to replace it.
  clock_.time = first + seconds(2);
  for (int i = 0; i < 100 && solver.attached(); ++i) solver.step(clock_);
  ASSERT_FALSE(solver.attached());
  EXPECT_TRUE(finished(reader)) << "the finish was taken, although its end had to be searched for";
  clock_.time += seconds(60);
  for (int i = 0; i < 10; ++i) {
    if (solver.attach(clock_)) solver.step(clock_);
  }
  EXPECT_EQ(reader.sample(clock_.time, state), SampleStatus::retired);
}

TEST_F(OldMotion, OfAFinishedStreamEndsBeforeTheStreamIsRecreated) {
  Solver solver(stream_.name(), {});
  std::optional<Producer> producer(std::in_place, stream_.name(), options_);
  ASSERT_TRUE(solver.attach(clock_));
  send_first(*producer);
  ASSERT_EQ(producer->finish(kHalt), AppendStatus::accepted);
  solver.step(clock_);
  Reader reader(stream_.name());
  State state(1);
  clock_.time = milliseconds(1450);
  ASSERT_EQ(reader.sample(clock_.time, state), SampleStatus::settled);
  ASSERT_GT(std::abs(state.velocity()[0]), 0.5);

  producer.reset();
  producer.emplace(stream_.name(), options_);
  solver.step(clock_);
  EXPECT_FALSE(solver.attached());
  int samples = 0;
  while (!solver.attach(clock_)) {
    ASSERT_LE(clock_.time, seconds(3));
    ASSERT_EQ(solver.due(), seconds(2));
    const SampleStatus status = reader.sample(clock_.time, state);
    ASSERT_TRUE(has_values(status)) << to_string(status);
    clock_.time += milliseconds(1);
    ++samples;
  }
  EXPECT_EQ(samples, 550);
  EXPECT_EQ(clock_.time, seconds(2));
  EXPECT_LT(std::abs(state.velocity()[0]), 0.05);  // 1 ms before the full stop
  EXPECT_EQ(reader.sample(clock_.time, state), SampleStatus::retired);
  constexpr double kMovedTo = 7;
  ASSERT_EQ(producer->start_from({.position = {&kMovedTo, 1}}, {.moved = true}),
            AppendStatus::accepted);
  ASSERT_EQ(append(*producer, seconds(3), kMovedTo), AppendStatus::accepted);
  solver.step(clock_);
  Reader again(stream_.name());
  EXPECT_EQ(again.sample(clock_.time, state), SampleStatus::holding);
  EXPECT_EQ(state.position()[0], 7);
}

TEST_F(OldMotion, OfAStreamWhoseProducerWithdrewEndsWithItsStopSegment) {
  Solver solver(stream_.name(), {.stop_time = milliseconds(400)});
  std::optional<Producer> producer(std::in_place, stream_.name(), options_);
  ASSERT_TRUE(solver.attach(clock_));
  send_first(*producer);
  solver.step(clock_);
  producer->withdraw();
  producer.reset();
  producer.emplace(stream_.name(), options_);
  clock_.time = milliseconds(2050);
  solver.step(clock_);
  EXPECT_FALSE(solver.attach(clock_));
  EXPECT_EQ(end_of_old_motion(stream_.name(), producer->stream_id(), {}), milliseconds(2400));
  clock_.time = milliseconds(2400);
  EXPECT_TRUE(solver.attach(clock_));
  EXPECT_EQ(end_of_old_motion(stream_.name(), producer->stream_id(), {}), Time::min());
}

TEST_F(OldMotion, OfAStreamInASweepAlsoEndsBeforeTheStreamIsRecreated) {
  std::vector<SweepNews> news;
  StreamSweep sweep({stream_.name()}, {},
                    [&](SweepNews what, const std::string& /*stream*/, const Solver* /*solver*/,
                        std::string_view /*why*/) { news.push_back(what); });
  std::optional<Producer> producer(std::in_place, stream_.name(), options_);
  const auto solve_until = [&](Time t) {
    for (; clock_.time < t; clock_.time += milliseconds(1)) sweep.sweep(clock_);
  };
  solve_until(milliseconds(500));
  ASSERT_EQ(sweep.solved(), 1U);
  send_first(*producer);
  ASSERT_EQ(producer->finish(kHalt), AppendStatus::accepted);
  solve_until(milliseconds(1500));
  producer.reset();
  producer.emplace(stream_.name(), options_);
  solve_until(seconds(2));
  EXPECT_EQ(sweep.solved(), 0U);
  solve_until(milliseconds(2200));
  EXPECT_EQ(sweep.solved(), 1U);
  EXPECT_TRUE(producer->wait_for_solver(seconds(1)));
  EXPECT_EQ(news, (std::vector{SweepNews::waiting, SweepNews::solving, SweepNews::finished,
                               SweepNews::waiting, SweepNews::solving}));
}

TEST_F(OldMotion, OfMoreThanAnHourIsRefusedWithItsEnd) {
  Solver solver(stream_.name(), {});
  std::optional<Producer> producer(std::in_place, stream_.name(), options_);
  ASSERT_TRUE(solver.attach(clock_));
  ASSERT_EQ(append(*producer, seconds(3000), 0), AppendStatus::accepted);
  ASSERT_EQ(append(*producer, seconds(6000), 1), AppendStatus::accepted);
  ASSERT_EQ(producer->finish(kHalt), AppendStatus::accepted);
  solver.step(clock_);
  producer.reset();
  producer.emplace(stream_.name(), options_);
  solver.step(clock_);
  try {
    solver.attach(clock_);
    FAIL() << "attached";
  } catch (const BadRegion& error) {
    EXPECT_NE(std::string(error.what()).find("ends at 6000000000000 ns"), std::string::npos);
  }
}

}  // namespace
}  // namespace splinecast::ipc
