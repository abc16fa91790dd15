#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <optional>

#include "splinecast/clock.hpp"
#include "splinecast/producer.hpp"
#include "splinecast/rate_commander.hpp"
#include "splinecast/reader.hpp"
#include "splinecast/solver.hpp"
#include "tests/fixtures/processes/clock_reading.hpp"
#include "tests/fixtures/processes/process.hpp"

/// Readers of a stream under a law that are delayed directly before they read the clock.
namespace splinecast {
namespace {

using std::chrono::milliseconds;
using testing::TestStream;

constexpr Time kAhead = milliseconds(20);

class ReaderOrder : public ::testing::Test {
 protected:
  void SetUp() override {
    commander_.set_rate(1, milliseconds(1));
    ASSERT_TRUE(law_solver_.attach());
    Reader law(law_.name());
    State state(1);
    ASSERT_TRUE(testing::await([&] {
      (void)law_solver_.step(clock_);
      return has_values(law.preview(clock_.now(), state));
    }));
    producer_.emplace(arm_.name(), ProducerOptions{.clock = StreamClock::law, .law = law_.name()});
    ASSERT_TRUE(testing::await([&] { return arm_solver_.attach(); }));
    const Time begin = producer_->now() + milliseconds(300);
    for (int i = 0; i < 100; ++i) {
      const std::array x{0.1 * i};
      ASSERT_EQ(producer_->append({.time = begin + i * milliseconds(100), .position = x}),
                AppendStatus::accepted);
    }
    ASSERT_TRUE(testing::await([&] {
      (void)arm_solver_.step(clock_);
      return producer_->now() > begin + milliseconds(20);
    }));
  }

  /// Samples a time ahead, at which the law has not settled but the curve has. Before the clock is
  /// read, the law is held, and the time passes.
  template <typename Sample>
  void hold_before_the_clock_is_read(const Sample& sample) {
    Reader reader(arm_.name());
    (void)arm_solver_.step(clock_);
    const Time host = clock_.now() + kAhead;
    SampleStatus status{};
    State state(1);
    {
      const testing::BeforeEachClockReading delay([&] {
        commander_.hold(milliseconds(1));
        (void)law_solver_.step(clock_);
        while (clock_.now() <= host) (void)law_solver_.step(clock_);
      });
      status = sample(reader, host, state);
    }
    State after(1);
    Reader second(arm_.name());
    ASSERT_TRUE(has_values(second.preview(host, after)));
    if (status == SampleStatus::settled) {
      EXPECT_EQ(state.position()[0], after.position()[0]);
    }
    EXPECT_EQ(status, SampleStatus::settled);
  }

  TestStream law_;
  TestStream arm_;
  MonotonicClock clock_;
  RateCommander commander_{law_.name(), "operator"};
  Solver law_solver_{law_.name(), {}};
  std::optional<Producer> producer_;
  Solver arm_solver_{arm_.name(), {.freeze_ahead = milliseconds(100)}};
};

TEST_F(ReaderOrder, OneSampleThatHasSettledDoesNotChange) {
  hold_before_the_clock_is_read(
      [](Reader& reader, Time host, State& state) { return reader.sample(host, state); });
}

TEST_F(ReaderOrder, OneOfManySamplesThatHasSettledDoesNotChange) {
  hold_before_the_clock_is_read([](Reader& reader, Time host, State& state) {
    std::array times{host};
    std::array<SampleStatus, 1> status{};
    std::array<double, 1> value{};
    const SampleBlock block{
        .values = value, .status = status, .derivatives = Derivatives::position};
    (void)reader.sample_many(times, block);
    state.ref().position[0] = value[0];
    return status[0];
  });
}

}  // namespace
}  // namespace splinecast
