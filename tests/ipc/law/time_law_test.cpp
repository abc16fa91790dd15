#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "ipc/roles/internals.hpp"
#include "splinecast/errors.hpp"
#include "splinecast/producer.hpp"
#include "splinecast/rate_commander.hpp"
#include "splinecast/reader.hpp"
#include "splinecast/solver.hpp"
#include "splinecast/streams.hpp"
#include "tests/fixtures/processes/process.hpp"
#include "tests/ipc/law/time_law.hpp"

/// Streams that follow a time law, through the public headers, with simulated time.
namespace splinecast {
namespace {

using std::chrono::hours;
using std::chrono::milliseconds;
using testing::HostClock;
using testing::kInterval;
using testing::TestStream;
using testing::TimeLaw;

TEST_F(TimeLaw, MovesTheStreamAtTheRateThatIsRequested) {
  pass(milliseconds(2500));  // the entry from rest ends
  operator_.set_rate(0.25, milliseconds(200));
  pass(milliseconds(300));
  State state(1);
  ASSERT_EQ(reader_->sample(clock_.now(), state), SampleStatus::settled);
  EXPECT_EQ(reader_->rate().rate, 0.25);
  const Time before = reader_->rate().stream_time;
  pass(milliseconds(400));
  ASSERT_EQ(reader_->sample(clock_.now(), state), SampleStatus::settled);
  EXPECT_NEAR(to_seconds(reader_->rate().stream_time - before), 0.1, 1e-8);
  const double s = to_seconds(reader_->rate().stream_time - origin_);
  EXPECT_NEAR(state.position()[0], std::sin(2 * s), 1e-4);
  EXPECT_NEAR(state.velocity()[0], 0.25 * 2 * std::cos(2 * s), 1e-3);
}

TEST_F(TimeLaw, GivesTheDerivativesByHostTimeThroughRampsThatInterruptRamps) {
  pass(milliseconds(500));
  Reader law(law_.name());
  State of_law(1);
  Snapshot curve(1);
  double largest_error = 0;
  int request = 0;
  watch(milliseconds(3000), [&](const State& state, SampleStatus) {
    if (++request % 90 == 0) {
      operator_.set_rate(request % 360 == 0 ? 0 : 0.1 * (request % 11), milliseconds(160));
    }
    ASSERT_TRUE(has_values(law.preview(clock_.now(), of_law)));
    const long double s = of_law.position()[0];
    const Time near = law_origin() + Time(static_cast<std::int64_t>(s * 1e9L));
    ASSERT_TRUE(has_values(reader_->snapshot(near, near, curve)));
    const SnapshotSegment segment = curve[0];
    const long double u =
        s - static_cast<long double>((segment.left - law_origin()).count()) / 1e9L;
    std::array<long double, 4> x{};  // derivatives by stream time
    for (std::size_t r = 0; r < 4; ++r) {
      for (auto k = static_cast<std::size_t>(segment.order); k-- > r;) {
        long double factor = 1;
        for (std::size_t i = 0; i < r; ++i) factor *= static_cast<long double>(k - i);
        x[r] = x[r] * u + factor * static_cast<long double>(segment.coefficients[k]);
      }
    }
    const long double r = of_law.velocity()[0];
    const long double a = of_law.acceleration()[0];
    const long double j = of_law.jerk()[0];
    const std::array wanted{x[0], x[1] * r, x[2] * r * r + x[1] * a,
                            x[3] * r * r * r + 3 * x[2] * r * a + x[1] * j};
    for (std::size_t i = 0; i < 4; ++i) {
      const double error =
          std::abs(static_cast<double>(wanted[i] - static_cast<long double>(state.values()[i])));
      largest_error =
          std::max(largest_error, error / std::max(1.0, static_cast<double>(std::abs(wanted[i]))));
    }
  });
  EXPECT_LT(largest_error, 1e-9);
}

/// By how much a value has changed within 1 ms beyond what its derivative at the two ends explains.
double unexplained(double step, double derivative, double next_derivative) {
  const auto [least, most] = std::minmax(derivative, next_derivative);
  return std::max({step - most * 1e-3, least * 1e-3 - step, 0.0});
}

TEST_F(TimeLaw, NeverStepsOrGoesBack) {
  pass(milliseconds(500));
  State last(1);
  Time last_stream = Time::min();
  int requests = 0;
  watch(milliseconds(4000), [&](const State& state, SampleStatus status) {
    EXPECT_EQ(status, SampleStatus::settled);
    if (++requests % 37 == 0) {
      operator_.set_rate((requests / 37 * 7 % 11) / 10.0, milliseconds(20 + requests % 90));
    }
    EXPECT_GE(reader_->rate().stream_time, last_stream);
    EXPECT_GE(reader_->rate().rate, 0);
    EXPECT_LE(reader_->rate().rate, 1);
    if (last_stream > Time::min()) {
      // The shortest ramp is 20 ms: its jerk is at most 3e4 /s³, and changes by at most 3e3 in 1
      // ms.
      const auto within = [&](auto of, auto derivative) {
        return unexplained(of(state) - of(last), derivative(last), derivative(state));
      };
      const auto x = [](const State& s) { return s.position()[0]; };
      const auto v = [](const State& s) { return s.velocity()[0]; };
      const auto a = [](const State& s) { return s.acceleration()[0]; };
      const auto j = [](const State& s) { return s.jerk()[0]; };
      EXPECT_LE(within(x, v), 1e-6);
      EXPECT_LE(within(v, a), 2e-4);
      EXPECT_LE(within(a, j), 3);
    }
    last = state;
    last_stream = reader_->rate().stream_time;
  });
}

TEST_F(TimeLaw, AHoldOfAnHourLosesNothing) {
  pass(milliseconds(700));
  operator_.hold(milliseconds(100));
  pass(milliseconds(150));
  State before(1);
  ASSERT_EQ(reader_->sample(clock_.now(), before), SampleStatus::settled);
  EXPECT_EQ(reader_->rate().rate, 0);
  EXPECT_EQ(before.velocity()[0], 0);
  const auto revision = reader_->progress()->revision;
  pass(hours(1), milliseconds(500));
  State after(1);
  ASSERT_EQ(reader_->sample(clock_.now(), after), SampleStatus::settled);
  EXPECT_EQ(after.position()[0], before.position()[0]);
  EXPECT_EQ(reader_->progress()->revision, revision) << "a held stream publishes nothing";
  operator_.set_rate(1, milliseconds(100));
  State last = after;
  watch(milliseconds(500), [&](const State& state, SampleStatus status) {
    EXPECT_EQ(status, SampleStatus::settled);
    EXPECT_LE(std::abs(state.position()[0] - last.position()[0]), 2.8e-3);
    last = state;
  });
  EXPECT_EQ(reader_->rate().rate, 1);
}

TEST_F(TimeLaw, TheLeastRequestWinsAndAReleaseGivesItUp) {
  RateCommander stop(law_.name(), "estop");
  pass(milliseconds(500));
  State state(1);
  const auto rate = [&] {
    EXPECT_TRUE(has_values(reader_->sample(clock_.now(), state)));
    return reader_->rate().rate;
  };
  stop.set_rate(0.5, milliseconds(50));
  pass(milliseconds(100));
  EXPECT_EQ(rate(), 0.5);
  operator_.set_rate(0.75, milliseconds(50));
  pass(milliseconds(100));
  EXPECT_EQ(rate(), 0.5);
  stop.hold(milliseconds(50));
  pass(milliseconds(100));
  EXPECT_EQ(rate(), 0);
  stop.release(milliseconds(50));
  pass(milliseconds(100));
  EXPECT_EQ(rate(), 0.75);
  operator_.release(milliseconds(50));
  pass(milliseconds(100));
  EXPECT_EQ(rate(), 1);
}

TEST_F(TimeLaw, ContinuesAtItsRateWithoutItsSolverAndIsTakenOverByTheNext) {
  pass(milliseconds(300));
  operator_.set_rate(0.5, milliseconds(50));
  pass(milliseconds(100));
  law_solver_.reset();
  State last(1);
  ASSERT_TRUE(has_values(reader_->sample(clock_.now(), last)));
  watch(milliseconds(300), [&](const State& state, SampleStatus) {
    EXPECT_EQ(reader_->rate().rate, 0.5);
    EXPECT_LE(std::abs(state.position()[0] - last.position()[0]), 1.5e-3);
    last = state;
  });
  operator_.set_rate(1, milliseconds(50));
  law_solver_.emplace(law_.name(), SolverOptions{});
  ASSERT_TRUE(law_solver_->attach(clock_));
  EXPECT_TRUE(law_solver_->took_over());
  watch(milliseconds(200), [&](const State& state, SampleStatus) {
    EXPECT_LE(std::abs(state.position()[0] - last.position()[0]), 2.8e-3);
    last = state;
  });
  EXPECT_EQ(reader_->rate().rate, 1);
}

TEST_F(TimeLaw, ReadersOfTwoStreamsHaveTheSameStreamTime) {
  TestStream gripper;
  Producer producer(gripper.name(), {.clock = StreamClock::law, .law = law_.name()});
  Solver solver(gripper.name(), {});
  ASSERT_TRUE(solver.attach(clock_));
  const Time begin = stream_now() + milliseconds(100);
  for (int i = 0; i < 100; ++i) {
    const std::array x{0.01 * i};
    ASSERT_EQ(producer.append({.time = begin + i * kInterval, .position = x}),
              AppendStatus::accepted);
  }
  (void)solver.step(clock_);
  Reader other(gripper.name());
  operator_.set_rate(0.3, milliseconds(300));
  State state(1);
  watch(milliseconds(400), [&](const State&, SampleStatus) {
    (void)solver.step(clock_);
    ASSERT_TRUE(has_values(other.sample(clock_.now(), state)));
    EXPECT_EQ(other.rate().stream_time, reader_->rate().stream_time);
    EXPECT_EQ(other.rate().rate, reader_->rate().rate);
  });
}

TEST_F(TimeLaw, ManyTimesAreSampledAsOneByOne) {
  pass(milliseconds(500));
  operator_.set_rate(0.4, milliseconds(100));
  pass(milliseconds(20));
  std::vector<Time> times;
  for (int i = 0; i < 50; ++i) times.push_back(clock_.now() + milliseconds(i));
  std::vector<double> values(times.size() * 2);
  std::vector<SampleStatus> status(times.size());
  const auto which = Derivatives::position | Derivatives::acceleration;
  ASSERT_GT(reader_->sample_many(times, {.values = values, .status = status, .derivatives = which}),
            0U);
  State state(1);
  for (std::size_t i = 0; i < times.size(); ++i) {
    EXPECT_EQ(reader_->preview(times[i], state), status[i]);
    EXPECT_EQ(values[2 * i], state.position()[0]);
    EXPECT_EQ(values[2 * i + 1], state.acceleration()[0]);
  }
}

TEST_F(TimeLaw, IsNeededByTheStreamsThatNameIt) {
  TestStream other;
  EXPECT_THROW(Producer(other.name(), {.clock = StreamClock::law, .law = "none-" + law_.name()}),
               NoSuchStream);
  EXPECT_THROW(Producer(other.name(), {.clock = StreamClock::law}), BadRequest);
  EXPECT_THROW(Producer(other.name(), {.law = law_.name()}), BadRequest);
  EXPECT_THROW(Producer(other.name(), {.clock = StreamClock::law, .law = arm_.name()}),
               NoSuchStream);
  EXPECT_THROW(RateCommander(law_.name(), "operator"), StreamBusy);
  EXPECT_THROW(RateCommander(law_.name(), "a@b"), BadRequest);
  EXPECT_THROW(operator_.set_rate(-1, milliseconds(10)), BadRequest);
  EXPECT_THROW(operator_.set_rate(1, Time(1)), BadRequest);
}

TEST(RateCommanders, ADeadManHoldsTheLawUnlessItIsRenewed) {
  const TestStream law;
  RateCommander panel(law.name(), "panel");
  panel.set_dead_man(milliseconds(50), milliseconds(20));
  panel.set_rate(1, milliseconds(5));
  Solver solver(law.name(), {});
  const MonotonicClock clock;
  ASSERT_TRUE(solver.attach(clock));
  std::optional<Reader> reader;
  State state(1);
  const auto rate = [&] {
    (void)solver.step(clock);
    if (!reader) reader.emplace(law.name(), milliseconds(100));
    return has_values(reader->preview(clock.now(), state)) ? state.velocity()[0] : -1;
  };
  Time renewed = clock.now();
  // A machine under load may pause this process for longer than the dead man: begins again then.
  for (Time end = clock.now() + milliseconds(200); clock.now() < end;) {
    const Time now = clock.now();  // before the renewal: its own time is not earlier
    const Time pause = now - renewed;
    if (pause > milliseconds(40)) {
      panel.set_rate(1, milliseconds(5));
      end = clock.now() + milliseconds(200);
    } else if (pause > milliseconds(5)) {
      panel.renew();
    }
    if (pause > milliseconds(5)) renewed = now;
    const bool is_settled = end - clock.now() < milliseconds(150);
    if (rate() >= 0 && is_settled && clock.now() - renewed < milliseconds(20)) {
      EXPECT_GT(state.velocity()[0], 0);
    }
  }
  const Time limit = clock.now() + testing::kPatience;
  while (rate() > 0 && clock.now() < limit) solver.wait(milliseconds(1));
  EXPECT_EQ(rate(), 0);
}

}  // namespace
}  // namespace splinecast
