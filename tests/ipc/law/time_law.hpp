#pragma once

#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <cmath>
#include <optional>

#include "ipc/roles/internals.hpp"
#include "splinecast/producer.hpp"
#include "splinecast/rate_commander.hpp"
#include "splinecast/reader.hpp"
#include "splinecast/solver.hpp"
#include "tests/fixtures/processes/process.hpp"

namespace splinecast::testing {

using std::chrono::milliseconds;

inline constexpr Time kInterval = milliseconds(20);

/// A host's clock that the test advances.
class HostClock final : public Clock {
 public:
  [[nodiscard]] Time now() const noexcept override {
    if (readings_ > 0 && --readings_ == 0) now_ += pause_;
    return now_;
  }
  void advance(Time by) { now_ += by; }
  /// Delays the process that reads this clock directly before one of its next readings, from 1 on.
  void pause_before(int reading, Time pause) {
    readings_ = reading;
    pause_ = pause;
  }

 private:
  mutable Time now_ = MonotonicClock().now();
  mutable int readings_ = 0;
  Time pause_{};
};

/// A law and a stream of one dimension that follows it: a sine of stream time.
class TimeLaw : public ::testing::Test {
 protected:
  TimeLaw() {
    operator_.set_rate(1, milliseconds(100));
    law_solver_.emplace(law_.name(), SolverOptions{});
    EXPECT_TRUE(law_solver_->attach(clock_));
    pass(milliseconds(50));  // the law begins
    producer_.emplace(arm_.name(), ProducerOptions{.clock = StreamClock::law, .law = law_.name()});
    EXPECT_TRUE(arm_solver_.attach(clock_));
    origin_ = stream_now() + milliseconds(300);
    next_ = origin_;
    pass(milliseconds(100));
    reader_.emplace(arm_.name());
  }

  /// Stream time of the law now, as its board has it.
  [[nodiscard]] Time stream_now() {
    State state(1);
    EXPECT_TRUE(has_values(law_reader().preview(clock_.now(), state)));
    return law_origin() + Time(static_cast<std::int64_t>(state.position()[0] * 1e9));
  }
  [[nodiscard]] Time law_origin() { return Time(ipc::Internals::header(law_reader()).law_origin); }
  Reader& law_reader() {
    if (!law_reader_) law_reader_.emplace(law_.name());
    return *law_reader_;
  }

  static double position(double seconds) { return std::sin(2 * seconds); }

  /// Lets host time pass. The producer keeps waypoints for 400 ms of stream time ahead.
  void pass(Time time, Time step = milliseconds(1)) {
    for (const Time end = clock_.now() + time; clock_.now() < end;) {
      clock_.advance(step);
      if (producer_) produce();
      if (law_solver_) (void)law_solver_->step(clock_);
      if (arm_solver_.attached()) (void)arm_solver_.step(clock_);
    }
  }
  void produce() {
    const Time until = stream_now() + milliseconds(400);
    for (; next_ < until; next_ += kInterval) {
      const std::array x{position(to_seconds(next_ - origin_))};
      ASSERT_EQ(producer_->append({.time = next_, .position = x}), AppendStatus::accepted);
    }
  }

  /// Samples every millisecond, and calls `look` with each state.
  template <typename Look>
  void watch(Time time, const Look& look) {
    State state(1);
    for (const Time end = clock_.now() + time; clock_.now() < end;) {
      pass(milliseconds(1));
      const SampleStatus status = reader_->sample(clock_.now(), state);
      ASSERT_TRUE(has_values(status)) << to_string(status);
      look(state, status);
    }
  }

  TestStream law_;
  TestStream arm_;
  HostClock clock_;
  RateCommander operator_{law_.name(), "operator"};
  std::optional<Solver> law_solver_;
  Solver arm_solver_{arm_.name(), {}};
  std::optional<Producer> producer_;
  std::optional<Reader> reader_;
  std::optional<Reader> law_reader_;
  Time origin_{};
  Time next_{};
};

}  // namespace splinecast::testing
