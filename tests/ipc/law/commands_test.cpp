#include "ipc/law/commands.hpp"

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <chrono>
#include <limits>
#include <memory>
#include <string>

#include "ipc/layout/header.hpp"
#include "ipc/mapping/checked_region.hpp"
#include "ipc/mapping/owner_lock.hpp"
#include "ipc/memory/names.hpp"
#include "ipc/owned/ring.hpp"
#include "splinecast/rate_commander.hpp"
#include "tests/fixtures/processes/process.hpp"

namespace splinecast::ipc {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using testing::TestStream;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// A commander's ring into which a test appends any values.
class AnyCommander {
 public:
  AnyCommander(const std::string& law, const std::string& name)
      : lock_(commander_stream(law, name), RegionKind::waypoints),
        ring_(own_ring(commander_stream(law, name), command_ring_options({}, {}), lock_)) {
    lock_.keep_file();
  }

  void give(Time time, const std::array<double, kCommandValues>& values) {
    EXPECT_EQ(ring_.writer.append({.time = time, .position = values},
                                  {.consumed = ring_.writer.written()}),
              AppendStatus::accepted);
  }

  /// Overwrites a value of the newest item, as a faulty process could.
  void overwrite(std::size_t value, double by) {
    const Word newest = (ring_.writer.written() - 1) % ring_.layout.capacity;
    const std::size_t at =
        ring_.layout.items + newest * ring_.layout.stride + (kItemValues + value) * sizeof(Word);
    auto* const words = reinterpret_cast<Word*>(ring_.region.bytes().data() + at);
    store(*words, std::bit_cast<Word>(by), std::memory_order_release);
  }

 private:
  OwnerLock lock_;
  OwnedRing ring_;
};

/// The commanders of a law that no process solves, at times that the test chooses.
class LawCommanders : public ::testing::Test {
 protected:
  /// The least rate that is requested.
  double read(Time now, double largest = 1) {
    commanders_.look_around();
    commanders_.read(now);
    return least_rate(commanders_.states(), largest);
  }
  /// What the first commander asks of a law.
  core::RateRequest request() { return commanders_.states().front().request(1); }
  TestStream law_;
  Commanders commanders_{law_.name(), {}};
};

TEST_F(LawCommanders, WithoutARequestTheRateIsOne) {
  EXPECT_EQ(read(seconds(1)), 1);
  EXPECT_TRUE(commanders_.empty());
  AnyCommander one(law_.name(), "one");
  EXPECT_EQ(read(seconds(1)), 1);
  EXPECT_FALSE(commanders_.empty());
  EXPECT_EQ(read(seconds(1), 0.5), 0.5) << "at most the largest rate";
}

TEST_F(LawCommanders, TheLeastRequestWins) {
  AnyCommander one(law_.name(), "one");
  AnyCommander two(law_.name(), "two");
  one.give(seconds(1), {0.5, 0.1, 0});
  two.give(seconds(2), {0.25, 0.2, 0});
  EXPECT_EQ(read(seconds(3)), 0.25);
  EXPECT_FALSE(commanders_.calls());
  two.give(seconds(4), {-1, 0.4, 0});
  EXPECT_TRUE(commanders_.calls());
  EXPECT_EQ(read(seconds(5)), 0.5);
}

TEST_F(LawCommanders, OnlyTheNewestCommandOfACommanderCounts) {
  AnyCommander one(law_.name(), "one");
  // More than the ring holds.
  for (int i = 1; i <= 1000; ++i) one.give(seconds(i), {1.0 / i, 0.1, 0});
  EXPECT_EQ(read(seconds(2000)), 1.0 / 1000);
}

TEST_F(LawCommanders, ADeadManExpiresUnlessACommandFollows) {
  AnyCommander one(law_.name(), "one");
  EXPECT_EQ(commanders_.next_expiry(), Time::max());
  one.give(seconds(1), {0.5, 0.1, 2});
  EXPECT_EQ(read(seconds(3) - Time(1)), 0.5);
  EXPECT_EQ(commanders_.next_expiry(), seconds(3));
  EXPECT_EQ(read(seconds(3)), 0);
  EXPECT_TRUE(commanders_.states().front().is_dead);
  EXPECT_EQ(request().ramp, kDeadManRamp);
  EXPECT_EQ(commanders_.next_expiry(), Time::max());
  one.give(seconds(4), {0.5, 0.1, 2});
  EXPECT_EQ(read(seconds(4)), 0.5);
  one.give(seconds(5), {-1, 0.1, 2});
  EXPECT_EQ(read(seconds(100)), 1) << "a withdrawn request does not expire";
}

TEST_F(LawCommanders, ValuesOutOfRangeAreClamped) {
  AnyCommander one(law_.name(), "one");
  one.give(seconds(1), {1e9, 1e9, 0});
  EXPECT_EQ(read(seconds(1)), 1);
  EXPECT_EQ(request().ramp, kLongestRamp);
  one.give(seconds(2), {0.5, -1, -1});
  EXPECT_EQ(read(seconds(3)), 0.5);
  EXPECT_EQ(request().ramp, kShortestRamp);
  EXPECT_FALSE(commanders_.states().front().is_dead);
  one.give(seconds(4), {0.5, 1e-9, 1e9});
  (void)read(seconds(4));
  EXPECT_EQ(request().ramp, kShortestRamp);
  EXPECT_EQ(commanders_.next_expiry(), seconds(4) + kLongestRamp);
}

TEST_F(LawCommanders, ACommandThatIsNotFiniteIsIgnored) {
  AnyCommander one(law_.name(), "one");
  Time now{};
  const auto next = [&now] { return now += seconds(1); };
  for (const double value : {kInfinity, -kInfinity, std::numeric_limits<double>::quiet_NaN()}) {
    for (std::size_t i = 0; i < kCommandValues; ++i) {
      one.give(next(), {0.5, 0.1, 0});
      EXPECT_EQ(read(now), 0.5);
      one.give(next(), {0.25, 0.2, 0});
      one.overwrite(i, value);
      EXPECT_EQ(read(now), 0.5) << value << " as value " << i;
      EXPECT_EQ(request().ramp, milliseconds(100));
    }
  }
}

TEST_F(LawCommanders, ACommanderThatEndedIsRemembered) {
  {
    RateCommander panel(law_.name(), "panel");
    panel.set_rate(0.25, milliseconds(50));
  }
  EXPECT_EQ(read(seconds(1)), 0.25);
  // Its successor requests nothing of its own yet.
  RateCommander panel(law_.name(), "panel");
  EXPECT_EQ(read(seconds(1)), 0.25);
  panel.release(milliseconds(50));
  EXPECT_EQ(read(seconds(1)), 1);
}

}  // namespace
}  // namespace splinecast::ipc
