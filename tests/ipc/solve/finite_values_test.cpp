#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "ipc/options/stream.hpp"
#include "ipc/sampling/sampler.hpp"
#include "splinecast/calculus.hpp"
#include "splinecast/waypoint.hpp"
#include "tests/fixtures/curves/streaming_methods.hpp"
#include "tests/fixtures/streams/memory_stream.hpp"

// All published values are finite, for any waypoints.
namespace splinecast::ipc {
namespace {

using std::chrono::milliseconds;
using testing::MemoryStream;

constexpr IntervalRange kNanosecond{.least = Time(1)};

Word reason(const MemoryStream& stream, Refusal refusal) {
  return stream.solver.summary().reasons[static_cast<std::size_t>(refusal)];
}

void expect_balance(const Summary& summary) {
  EXPECT_EQ(summary.consumed,
            summary.knots + summary.refused + summary.withdrawn + summary.controls);
}

/// A stream whose producer accepts intervals from 1 ns.
struct FastStream : MemoryStream {
  explicit FastStream(const core::WindowOptions& how,
                      const std::vector<Dimension>& dimension_kinds = {},
                      std::optional<LiveOptions> how_live = std::nullopt)
      : MemoryStream(std::max<std::size_t>(dimension_kinds.size(), 1), how, 64, 256, kNanosecond,
                     DimensionKinds(dimension_kinds), how_live) {
    ring.writer = WaypointRingWriter(ring.bytes.span(), ring.layout, kNanosecond);
  }
  /// Expects every sample between two times to have finite values.
  void expect_finite_samples(Time from, Time to) {
    Sampler sampler(board.reader, live ? StreamClock::monotonic : StreamClock::recorded);
    State state(ring.reader.dimensions());
    for (int i = 0; i <= 20; ++i) {
      const Time t = from + (to - from) / 20 * i;
      const SampleStatus status = sampler.preview(t, state.ref());
      if (status == SampleStatus::before_history || status == SampleStatus::no_data) continue;
      ASSERT_TRUE(has_values(status)) << static_cast<int>(status);
      const auto values = state.values();
      ASSERT_TRUE(std::ranges::all_of(values, [](double v) { return std::isfinite(v); }));
    }
  }
};

TEST(FiniteValues, AQuaternionTooShortForItsVelocityIsRefused) {
  const std::vector<Dimension> kinds(4, {.kind = DimensionKind::quaternion});
  FastStream stream({}, kinds);
  const auto send = [&](int ms, double length, double speed) {
    const std::vector<double> q{0, 0, 0, length};
    const std::vector<double> v{speed, 0, 0, 0};
    stream.send({.time = milliseconds(ms), .position = q, .velocity = v});
    stream.drain();
    EXPECT_NO_THROW(stream.replace_solver());
  };
  send(0, 1, 1);
  send(10, 1e-310, 1);    // does not define a rotation
  send(20, 1e-99, 1e10);  // its derivative at unit length is out of range
  send(30, 1e-99, 1e-90);
  send(40, 1e100, 1);
  send(50, 1, 1);
  EXPECT_EQ(reason(stream, Refusal::zero_quaternion), 2U);
  EXPECT_EQ(reason(stream, Refusal::not_finite), 1U);
  EXPECT_EQ(stream.solver.summary().knots, 3U);
  stream.expect_finite_samples(Time(0), milliseconds(300));
}

core::WindowOptions smoothing(double lambda) {
  return {.interpolant = {.method = find_method("smoothing"), .lambda = lambda},
          .settle = 10,
          .accepts_short_lag = true};
}

/// With λ/h³ = 1e33 next to intervals of 1,000 s, the equations of a smoothing spline exceed the
/// range of a double.
struct Poisoned : FastStream {
  Poisoned() : FastStream(smoothing(1e6)) {
    std::mt19937 random(1);
    Time t{};
    for (int i = 0; i < 200; ++i) {
      t += random() % 3 == 0 ? std::chrono::seconds(1000) : Time(1);
      sent.emplace_back(t, random() % 2 == 0 ? 1e100 : -1e100);
    }
    for (int i = 0; i < 20; ++i) sent.emplace_back(t += std::chrono::seconds(1000), 1);
    for (const auto& [time, x] : sent) send({.time = time, .position = {&x, 1}});
    drain();
  }
  [[nodiscard]] bool is_refused(Word item) const {
    for (Word k = 0; k < solver.summary().refused; ++k) {
      if (board.reader.refusal(k).item == item) return true;
    }
    return false;
  }
  std::vector<std::pair<Time, double>> sent;
};

TEST(FiniteValues, OnlyTheWaypointThatMakesTheCurveNotFiniteIsRefused) {
  Poisoned stream;
  EXPECT_NO_THROW(stream.replace_solver());
  stream.finish({ConditionKind::own, {}});
  EXPECT_NO_THROW(stream.replace_solver());
  const Summary& summary = stream.solver.summary();
  EXPECT_GT(reason(stream, Refusal::not_finite), 0U);
  EXPECT_LT(reason(stream, Refusal::not_finite), 20U);
  EXPECT_EQ(reason(stream, Refusal::not_finite), summary.refused);
  EXPECT_EQ(summary.knots + summary.refused, stream.sent.size());
  expect_balance(summary);
  stream.expect_finite_samples(Time(0), stream.sent.back().first);
}

/// The curve equals the curve of the waypoints that were not refused, for any number of waypoints
/// per step.
TEST(FiniteValues, ARefusedWaypointLeavesNoTrace) {
  Poisoned stream;
  FastStream other(smoothing(1e6));
  for (Word item = 0; item < stream.sent.size(); ++item) {
    const auto& [time, x] = stream.sent[item];
    if (stream.is_refused(item)) continue;
    other.send({.time = time, .position = {&x, 1}});
    other.drain();
  }
  EXPECT_EQ(other.solver.summary().refused, 0U);
  Sampler sampler(stream.board.reader, StreamClock::recorded);
  Sampler wanted(other.board.reader, StreamClock::recorded);
  State got(1);
  State want(1);
  for (const auto& [time, x] : stream.sent) {
    ASSERT_EQ(sampler.preview(time, got.ref()), wanted.preview(time, want.ref()));
    ASSERT_TRUE(std::ranges::equal(got.values(), want.values())) << time.count();
  }
}

class AnyValues : public ::testing::TestWithParam<const Method*> {};

/// Random values and intervals from the limits of their ranges.
class Extremes {
 public:
  explicit Extremes(std::uint64_t seed) : random_(seed) {}
  std::size_t pick(std::size_t size) {
    return std::uniform_int_distribution<std::size_t>(0, size - 1)(random_);
  }
  double value() {
    constexpr std::array kValues{0.0, 5e-324, 1e-310, 1e-150, 1e-100, 1e-10,
                                 1.0, 3.0,    1e10,   1e60,   1e100};
    return (pick(2) == 0 ? 1 : -1) * kValues[pick(kValues.size())];
  }
  Time interval() {
    constexpr std::array kIntervals{1L, 2L, 1'000L, 1'000'000L, 10'000'000L, 3'600'000'000'000L};
    return Time(kIntervals[pick(kIntervals.size())]);
  }
  std::vector<double> values(std::size_t n) {
    std::vector<double> all(n);
    std::ranges::generate(all, [&] { return value(); });
    return all;
  }

 private:
  std::mt19937_64 random_;
};

core::WindowOptions window_of(const Method& method, Extremes& extremes) {
  core::WindowOptions how{.interpolant = {.method = &method}};
  how.settle = core::default_settle(method);
  if (method.smooths()) {
    constexpr std::array kLambdas{0.0, 1e-30, 1.0, 1e6, 1e100};
    how.interpolant.lambda = kLambdas[extremes.pick(kLambdas.size())];
    how.settle = 10;
    how.accepts_short_lag = true;
  }
  if (extremes.pick(2) == 0) how.limits.acceleration = {1e-100, 0, 10, 1e100, 1};
  how.stop_length = extremes.pick(2) == 0 ? Time(1) : milliseconds(250);
  return how;
}

/// Appends a waypoint at t, or replaces the future by it. The first one may instead be a start
/// state.
void send_any(FastStream& stream, Extremes& extremes, Time t, bool is_first) {
  const auto x = extremes.values(5);
  const auto v = extremes.values(5);
  const auto a = extremes.values(5);
  const Waypoint waypoint{.time = t, .position = x, .velocity = v, .acceleration = a};
  const WaypointRingWriter::Solved solved{stream.board.reader.consumed()};
  if (is_first && extremes.pick(4) == 0) {
    (void)stream.ring.writer.start_from({t, x, v, a}, solved);
  } else if (extremes.pick(8) == 0) {
    (void)stream.ring.writer.replace_from(t - Time(1), {&waypoint, 1}, solved);
  } else {
    (void)stream.ring.writer.append(waypoint, solved);
  }
}

TEST_P(AnyValues, LeaveTheBoardFiniteAndRestorableAfterEveryStep) {
  const std::vector<Dimension> kinds{{},
                                     {.kind = DimensionKind::quaternion},
                                     {.kind = DimensionKind::quaternion},
                                     {.kind = DimensionKind::quaternion},
                                     {.kind = DimensionKind::quaternion}};
  for (std::uint64_t seed = 1; seed <= 150 && !HasFatalFailure(); ++seed) {
    SCOPED_TRACE(seed);
    Extremes extremes(seed);
    const bool is_live = seed % 2 == 0;
    core::WindowOptions how = window_of(*GetParam(), extremes);
    how.held_before_start = is_live;
    if (is_live) how.start.kind = ConditionKind::halt;
    FastStream stream(how, kinds, is_live ? std::optional(LiveOptions{}) : std::nullopt);
    stream.clock.time = std::chrono::seconds(1000);
    Time t = stream.clock.time + milliseconds(100);
    for (int i = 0; i < 40; ++i) {
      t += extremes.interval();
      send_any(stream, extremes, t, i == 0);
      if (extremes.pick(3) == 0) continue;
      stream.clock.time += extremes.pick(4) == 0 ? milliseconds(50) : Time(1000);
      for (int step = 0; step < 100; ++step) {
        const StepResult result = stream.solver.step(stream.clock);
        if (result.consumed == 0 && !result.published) break;
      }
      ASSERT_EQ(stream.solver.summary().consumed, stream.ring.writer.written());
      ASSERT_NO_THROW(stream.replace_solver());
      stream.expect_finite_samples(stream.clock.time, t + milliseconds(300));
    }
    stream.finish({is_live ? ConditionKind::halt : ConditionKind::own, {}});
    expect_balance(stream.solver.summary());
    ASSERT_NO_THROW(stream.replace_solver());
  }
}

INSTANTIATE_TEST_SUITE_P(Every, AnyValues, ::testing::ValuesIn(testing::streaming_methods()),
                         [](const auto& tested) { return std::string(tested.param->name); });

}  // namespace
}  // namespace splinecast::ipc
