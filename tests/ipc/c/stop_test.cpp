#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <string>

#include "tests/ipc/c/roles.hpp"
#include "tests/ipc/c/wrong_values.hpp"

/// Stoppers through the C interface.
namespace splinecast {
namespace {

using testing::CStream;
using testing::expect_refused;

constexpr std::int64_t kMs = 1'000'000;

splinecast_producer_options live() {
  splinecast_producer_options options = SPLINECAST_PRODUCER_OPTIONS_INIT;
  options.dimensions = 2;
  return options;
}

TEST(CStopper, HoldsALiveStreamUntilItIsReleased) {
  const CStream c(live());
  splinecast_stopper* stopper = nullptr;
  ASSERT_EQ(splinecast_stopper_create(c.name(), "panel", nullptr, &stopper), 0)
      << splinecast_last_error();
  EXPECT_EQ(splinecast_stopper_is_latched(stopper), 0);
  ASSERT_EQ(splinecast_stopper_stop(stopper), 0);
  EXPECT_EQ(splinecast_stopper_is_latched(stopper), 1);
  uint64_t number = 0;
  ASSERT_EQ(splinecast_stopper_number(stopper, &number), 0);
  EXPECT_EQ(splinecast_stopper_wait_in_force(stopper, number, 0), 0);
  const auto await = [&] {
    while (splinecast_stopper_wait_in_force(stopper, number, kMs) == 0) {
      ASSERT_GE(splinecast_solver_step(c.solver, nullptr), 0);
    }
  };
  await();
  EXPECT_EQ(c.append(splinecast_now() + 100 * kMs, 0, 0), SPLINECAST_APPEND_STOPPED);
  EXPECT_STREQ(splinecast_append_text(SPLINECAST_APPEND_STOPPED), "stopped");
  std::array<char, 40> names{};
  EXPECT_EQ(splinecast_producer_stopped_by(c.producer, names.data(), names.size()), 5);
  EXPECT_STREQ(names.data(), "panel");
  EXPECT_EQ(splinecast_stopper_destroy(stopper), 0);  // does not release
  ASSERT_EQ(splinecast_stopper_create(c.name(), "panel", nullptr, &stopper), 0);
  EXPECT_EQ(splinecast_stopper_is_latched(stopper), 1);
  ASSERT_EQ(splinecast_stopper_release(stopper), 0);
  ASSERT_EQ(splinecast_stopper_number(stopper, &number), 0);
  await();
  EXPECT_EQ(c.append(splinecast_now() + 100 * kMs, 0, 0), SPLINECAST_APPEND_ACCEPTED);
  EXPECT_EQ(splinecast_stopper_destroy(stopper), 0);
}

TEST(CStopper, NamesItselfInARefusal) {
  const CStream c(live());
  ASSERT_EQ(c.append(splinecast_now() + 100 * kMs, 0, 0), SPLINECAST_APPEND_ACCEPTED);
  splinecast_stopper* stopper = nullptr;
  ASSERT_EQ(splinecast_stopper_create(c.name(), "panel", nullptr, &stopper), 0);
  ASSERT_EQ(splinecast_stopper_stop(stopper), 0);
  uint64_t number = 0;
  ASSERT_EQ(splinecast_stopper_number(stopper, &number), 0);
  while (splinecast_stopper_wait_in_force(stopper, number, kMs) == 0) {
    ASSERT_GE(splinecast_solver_step(c.solver, nullptr), 0);
  }
  c.solve();
  std::array<splinecast_refusal, 2> items{};
  splinecast_refusals found = SPLINECAST_REFUSALS_INIT;
  found.items = items.data();
  found.capacity = items.size();
  ASSERT_EQ(splinecast_producer_refusals(c.producer, &found), 1);
  EXPECT_EQ(items[0].reason, SPLINECAST_REFUSAL_STOPPED);
  EXPECT_STREQ(items[0].by, "panel");
  std::array<char, 100> text{};
  EXPECT_GT(splinecast_refusal_message(items.data(), text.data(), text.size()), 0);
  EXPECT_NE(std::string(text.data()).find("stopped by 'panel'"), std::string::npos) << text.data();
  EXPECT_EQ(splinecast_stopper_destroy(stopper), 0);
}

TEST(CStopper, RefusesWhatAStopperMustNotHave) {
  const CStream c(live());
  splinecast_stopper* stopper = nullptr;
  splinecast_stopper* second = nullptr;
  ASSERT_EQ(splinecast_stopper_create(c.name(), "panel", nullptr, &stopper), 0);
  EXPECT_EQ(splinecast_stopper_create(c.name(), "panel", nullptr, &second), SPLINECAST_ERROR_BUSY);
  expect_refused("", "name", splinecast_stopper_create(c.name(), "a!b", nullptr, &second));
  splinecast_stopper_options options = SPLINECAST_STOPPER_OPTIONS_INIT;
  options.reserved = 1;
  expect_refused("options->reserved", "",
                 splinecast_stopper_create(c.name(), "b", &options, &second));
  EXPECT_EQ(splinecast_stopper_destroy(stopper), 0);
}

}  // namespace
}  // namespace splinecast
