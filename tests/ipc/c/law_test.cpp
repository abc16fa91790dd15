#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>

#include "tests/ipc/c/roles.hpp"
#include "tests/ipc/c/wrong_values.hpp"

/// Time laws through the C interface: a commander, and a stream that follows the law.
namespace splinecast {
namespace {

using testing::CState;
using testing::expect_refused;
using testing::TestStream;

constexpr std::int64_t kMs = 1'000'000;

/// A law whose solver this thread steps.
class CLaw : public ::testing::Test {
 protected:
  CLaw() {
    EXPECT_EQ(splinecast_rate_commander_create(law(), "operator", nullptr, &commander_), 0)
        << splinecast_last_error();
    splinecast_solver_options options = SPLINECAST_SOLVER_OPTIONS_INIT;
    options.largest_rate = 2;
    EXPECT_EQ(splinecast_solver_create(law(), &options, &law_solver_), 0)
        << splinecast_last_error();
  }
  CLaw(const CLaw&) = delete;
  CLaw& operator=(const CLaw&) = delete;
  ~CLaw() override {
    EXPECT_EQ(splinecast_reader_destroy(reader_), 0);
    EXPECT_EQ(splinecast_solver_destroy(solver_), 0);
    EXPECT_EQ(splinecast_solver_destroy(law_solver_), 0);
    EXPECT_EQ(splinecast_producer_destroy(producer_), 0);
    EXPECT_EQ(splinecast_rate_commander_destroy(commander_), 0);
  }
  [[nodiscard]] const char* law() const { return law_.name().c_str(); }

  void step() const {
    EXPECT_GE(splinecast_solver_step(law_solver_, nullptr), 0);
    if (solver_ == nullptr) return;
    EXPECT_GE(splinecast_solver_step(solver_, nullptr), 0);
  }

  /// Begins the law and a stream that follows it, whose waypoints are a minute apart.
  void begin() {
    ASSERT_EQ(splinecast_rate_commander_set_rate(commander_, 1, 5 * kMs), 0);
    ASSERT_EQ(splinecast_solver_attach(law_solver_), 1) << splinecast_last_error();
    step();
    const char* arm = arm_.name().c_str();
    splinecast_producer_options options = SPLINECAST_PRODUCER_OPTIONS_INIT;
    options.clock = SPLINECAST_CLOCK_LAW;
    options.law = law();
    ASSERT_EQ(splinecast_producer_create(arm, &options, &producer_), 0) << splinecast_last_error();
    ASSERT_EQ(splinecast_solver_create(arm, nullptr, &solver_), 0) << splinecast_last_error();
    while (splinecast_solver_attach(solver_) == 0) step();  // until the law begins
    ASSERT_EQ(splinecast_solver_attached(solver_), 1) << splinecast_last_error();
    ASSERT_EQ(splinecast_producer_now(producer_, &start_), 0);
    for (int i = 0; i <= 10; ++i) {
      const double x = 0.1 * i;
      const splinecast_waypoint waypoint = {start_ + 60'000 * kMs * (i + 1), {&x, 1, 1}, {}, {}};
      ASSERT_EQ(splinecast_producer_append(producer_, &waypoint), SPLINECAST_APPEND_ACCEPTED);
    }
    step();
    ASSERT_EQ(splinecast_reader_create(arm, 0, nullptr, &reader_), 0) << splinecast_last_error();
    EXPECT_EQ(splinecast_reader_clock(reader_), SPLINECAST_CLOCK_LAW);
  }

  /// Steps until the sampled rate is this; then the stream's clock and the sample agree.
  void reach(double rate) {
    splinecast_law_rate found = {0, -1, 0};
    const std::int64_t limit = splinecast_now() + 60'000 * kMs;
    while (found.rate != rate && splinecast_now() < limit) {
      step();
      std::int64_t before = 0, after = 0;
      ASSERT_EQ(splinecast_producer_now(producer_, &before), 0);
      const int status = splinecast_reader_sample(reader_, splinecast_now(), &state_.state);
      ASSERT_TRUE(splinecast_has_values(status)) << status;
      ASSERT_EQ(splinecast_producer_now(producer_, &after), 0);
      ASSERT_EQ(splinecast_reader_rate(reader_, &found), 0);
      EXPECT_GE(found.stream_time, before);
      EXPECT_LE(found.stream_time, after);
    }
    EXPECT_EQ(found.rate, rate);
  }

  /// Steps until the preview of a stop begins at rest, and returns where.
  std::int64_t foreseen_rest() {
    splinecast_preview preview = SPLINECAST_PREVIEW_INIT;
    const std::int64_t limit = splinecast_now() + 60'000 * kMs;
    while (preview.from_rest == 0 && splinecast_now() < limit) {
      step();
      EXPECT_EQ(splinecast_producer_preview_replace(producer_, 0, nullptr, 0, &preview), 0)
          << splinecast_last_error();
    }
    return preview.begin;
  }

  TestStream law_;
  TestStream arm_;
  splinecast_rate_commander* commander_ = nullptr;
  splinecast_solver* law_solver_ = nullptr;
  splinecast_producer* producer_ = nullptr;
  splinecast_solver* solver_ = nullptr;
  splinecast_reader* reader_ = nullptr;
  std::int64_t start_ = 0;
  CState state_{1};
};

TEST_F(CLaw, HasTheRateThatIsRequested) {
  begin();
  ASSERT_EQ(splinecast_rate_commander_set_rate(commander_, 1.75, 5 * kMs), 0);
  reach(1.75);
  expect_refused("the largest rate", "",
                 splinecast_rate_commander_set_rate(commander_, 50, 5 * kMs));
  ASSERT_EQ(splinecast_rate_commander_set_rate(commander_, 2, 5 * kMs), 0);
  std::uint64_t number = 0;
  ASSERT_EQ(splinecast_rate_commander_number(commander_, &number), 0);
  EXPECT_EQ(number, 3U);
  EXPECT_EQ(splinecast_rate_commander_wait_in_force(commander_, number, kMs), 0);
  reach(2);
  EXPECT_EQ(splinecast_rate_commander_wait_in_force(commander_, number, 0), 1);
  EXPECT_EQ(splinecast_rate_commander_wait_in_force(commander_, number + 1, kMs), 0);
  ASSERT_EQ(splinecast_rate_commander_hold(commander_, 5 * kMs), 0);
  reach(0);
  ASSERT_EQ(splinecast_rate_commander_renew(commander_), 0);
  ASSERT_EQ(splinecast_rate_commander_release(commander_, 5 * kMs), 0);
  reach(1);
}

TEST_F(CLaw, SaysWhereAReplacementBegins) {
  begin();
  ASSERT_EQ(splinecast_rate_commander_hold(commander_, 5 * kMs), 0);
  reach(0);
  std::int64_t held = 0, begin = 0;
  int from_rest = -1;
  ASSERT_EQ(splinecast_producer_now(producer_, &held), 0);
  EXPECT_EQ(splinecast_producer_replacement_begin(producer_, &begin, &from_rest), 0);
  EXPECT_EQ(foreseen_rest(), held + 1);
  ASSERT_EQ(splinecast_producer_replace_from(producer_, 0, nullptr, 0), SPLINECAST_APPEND_ACCEPTED)
      << splinecast_last_error();
  while (splinecast_producer_replacement_begin(producer_, &begin, &from_rest) == 0) step();
  // The law may have settled only a part of the way that this looks ahead.
  EXPECT_GT(begin, held);
  if (from_rest == 1) {
    EXPECT_EQ(begin, held + 1);
  }
}

TEST_F(CLaw, HoldsWhenTheDeadManOfACommanderExpires) {
  begin();
  ASSERT_EQ(splinecast_rate_commander_set_dead_man(commander_, 20 * kMs, 20 * kMs), 0);
  ASSERT_EQ(splinecast_rate_commander_set_rate(commander_, 0.5, 5 * kMs), 0);
  reach(0);
  EXPECT_EQ(splinecast_rate_commander_renew(commander_), 1);
}

TEST_F(CLaw, RefusesRequestsThatAreOutOfRange) {
  for (const double rate : {-0.5, 100.5, std::numeric_limits<double>::quiet_NaN(),
                            std::numeric_limits<double>::infinity()}) {
    expect_refused("a rate", "", splinecast_rate_commander_set_rate(commander_, rate, 5 * kMs));
  }
  for (const std::int64_t ramp :
       {std::int64_t{0}, std::int64_t{999'999}, std::int64_t{-1},
        std::numeric_limits<std::int64_t>::max(), std::numeric_limits<std::int64_t>::min()}) {
    expect_refused("a ramp", "", splinecast_rate_commander_set_rate(commander_, 1, ramp));
    expect_refused("a ramp", "", splinecast_rate_commander_hold(commander_, ramp));
    expect_refused("a ramp", "", splinecast_rate_commander_release(commander_, ramp));
    expect_refused("a ramp", "", splinecast_rate_commander_set_dead_man(commander_, kMs, ramp));
    if (ramp == 0) continue;
    expect_refused("a dead man", "",
                   splinecast_rate_commander_set_dead_man(commander_, ramp, 20 * kMs));
  }
}

TEST_F(CLaw, HasOneCommanderOfAName) {
  splinecast_rate_commander* second = commander_;
  EXPECT_EQ(splinecast_rate_commander_create(law(), "operator", nullptr, &second),
            SPLINECAST_ERROR_BUSY);
  EXPECT_EQ(second, nullptr);
  expect_refused("", "name", splinecast_rate_commander_create(law(), "a@b", nullptr, &second));
  splinecast_rate_commander_options options = SPLINECAST_RATE_COMMANDER_OPTIONS_INIT;
  const auto create = [&] {
    return splinecast_rate_commander_create(law(), "b", &options, &second);
  };
  options.mode = 01000;
  expect_refused("options->mode", "", create());
  options = SPLINECAST_RATE_COMMANDER_OPTIONS_INIT;
  options.group = -2;
  expect_refused("options->group", "", create());
  options = SPLINECAST_RATE_COMMANDER_OPTIONS_INIT;
  options.owner = -2;
  expect_refused("options->owner", "", create());
  options = SPLINECAST_RATE_COMMANDER_OPTIONS_INIT;
  options.reserved = 1;
  expect_refused("options->reserved", "", create());
  options.size = 8;
  expect_refused("options->size", "", create());
}

TEST(CLawOptions, OfAnOlderVersionAreSmaller) {
  const TestStream stream;
  splinecast_producer_options options = SPLINECAST_PRODUCER_OPTIONS_INIT;
  options.size = offsetof(splinecast_producer_options, law);
  options.law = "not read";
  splinecast_producer* producer = nullptr;
  EXPECT_EQ(splinecast_producer_create(stream.name().c_str(), &options, &producer), 0)
      << splinecast_last_error();
  splinecast_solver_options how = SPLINECAST_SOLVER_OPTIONS_INIT;
  how.size = offsetof(splinecast_solver_options, largest_rate);
  how.largest_rate = -7;
  splinecast_solver* solver = nullptr;
  EXPECT_EQ(splinecast_solver_create(stream.name().c_str(), &how, &solver), 0)
      << splinecast_last_error();
  EXPECT_EQ(splinecast_solver_destroy(solver), 0);
  EXPECT_EQ(splinecast_producer_destroy(producer), 0);
}

}  // namespace
}  // namespace splinecast
