#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <random>
#include <span>
#include <string_view>

#include "splinecast/method.hpp"
#include "tests/fixtures/processes/allocations.hpp"
#include "tests/fixtures/streams/live_stream.hpp"
#include "tests/fixtures/streams/memory_stream.hpp"

/// No step of a solver allocates memory.
namespace splinecast::ipc {
namespace {

using std::chrono::milliseconds;
using testing::LiveStream;

core::WindowOptions limited(std::string_view method) {
  core::WindowOptions how;
  how.interpolant.method = find_method(method);
  if (how.interpolant.method->smooths()) {
    how.interpolant.lambda = 1e-9;
    how.settle = core::kMaxSettle;
  }
  how.limits = {.velocity = {3}, .acceleration = {10}, .lower = {-0.5}, .upper = {1.3}};
  return how;
}

/// A stream of which only the steps are counted.
struct Counted : LiveStream {
  Counted(std::string_view method, Beyond what) : LiveStream(limited(method)) {
    beyond = what;
    replace_solver();
  }
  void step() {
    const std::size_t before = testing::allocations();
    solver.step(clock);
    allocated += testing::allocations() - before;
  }
  void run_to(Time t) {
    for (; clock.time < t; clock.time += milliseconds(1)) step();
  }
  /// Noisy waypoints with steps and gaps, replacements and stops.
  void play() {
    std::mt19937 random(5);
    std::normal_distribution<double> noise(0, 0.002);
    const double start = 0;
    const WaypointRingWriter::Solved first{.consumed = 0};
    EXPECT_EQ(ring.writer.append({.time = kNow + milliseconds(50), .position = {&start, 1}}, first),
              AppendStatus::accepted);
    for (int i = 1; i < 1200; ++i) {
      const Time t = kNow + milliseconds(50 + 10 * i);
      run_to(t - milliseconds(80));
      const double x = 0.6 * (1 - std::cos(0.02 * i)) + (i % 150 > 130 ? 0.2 : 0) + noise(random);
      if (i % 200 == 170) (void)replace(clock.time + milliseconds(20), {});
      if (i % 200 == 90) (void)replace(t, {t + milliseconds(30), t + milliseconds(60)});
      if (i % 100 > 60 && i % 100 < 70) continue;  // starves
      (void)ring.writer.append({.time = t, .position = {&x, 1}}, solved());
    }
    run_to(clock.time + milliseconds(60));
    (void)ring.writer.finish({.kind = ConditionKind::halt, .value = {}}, solved());
    for (int i = 0; i < 5000 && !solver.summary().finished; ++i)
      run_to(clock.time + milliseconds(1));
    EXPECT_TRUE(solver.summary().finished);
  }

  std::size_t allocated = 0;
};

TEST(StepAllocation, IsNoneOnALiveStream) {
  for (const char* method : {"c2", "akima", "smoothing"}) {
    for (const Beyond what : {Beyond::report, Beyond::refuse, Beyond::enter}) {
      Counted live(method, what);
      live.play();
      EXPECT_EQ(live.allocated, 0U) << method << ' ' << static_cast<int>(what);
      EXPECT_GT(live.solver.summary().underruns, 0U);
      EXPECT_GT(live.solver.summary().controls, 8U);
    }
  }
}

TEST(StepAllocation, IsNoneOnARecordedStreamWithAnyEnd) {
  const double velocity = 0.3;
  for (const Condition& end :
       {Condition{}, Condition{.kind = ConditionKind::halt, .value = {}},
        Condition{.kind = ConditionKind::velocity, .value = {velocity}},
        Condition{.kind = ConditionKind::acceleration, .value = {velocity}}}) {
    testing::MemoryStream stream(1, {});
    std::size_t allocated = 0;
    const auto step = [&] {
      const std::size_t before = testing::allocations();
      stream.solver.step(stream.clock);
      allocated += testing::allocations() - before;
    };
    for (int i = 0; i < 300; ++i) {
      const double x = std::sin(0.1 * i);
      while (stream.append(milliseconds(10 * i), std::span(&x, 1)) == AppendStatus::full) step();
      if (i % 5 == 0) step();
    }
    (void)stream.ring.writer.finish(end, {.consumed = stream.board.reader.consumed()});
    for (int i = 0; i < 100 && !stream.solver.summary().finished; ++i) step();
    EXPECT_TRUE(stream.solver.summary().finished);
    EXPECT_EQ(allocated, 0U) << static_cast<int>(end.kind);
  }
}

}  // namespace
}  // namespace splinecast::ipc
