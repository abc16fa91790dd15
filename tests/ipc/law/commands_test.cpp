#include "ipc/law/commands.hpp"

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <chrono>
#include <string>
#include <utility>

#include "ipc/layout/header.hpp"
#include "ipc/layout/request_control.hpp"
#include "ipc/mapping/owner_lock.hpp"
#include "ipc/mapping/region.hpp"
#include "ipc/memory/names.hpp"
#include "ipc/options/stream.hpp"
#include "ipc/owned/request.hpp"
#include "splinecast/clock.hpp"
#include "splinecast/errors.hpp"
#include "splinecast/rate_commander.hpp"
#include "splinecast/streams.hpp"
#include "tests/fixtures/processes/process.hpp"

namespace splinecast::ipc {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using testing::TestStream;

/// A commander's region into which a test writes any record.
class AnyCommander {
 public:
  AnyCommander(const std::string& law, const std::string& name)
      : lock_(commander_stream(law, name), RegionKind::commander),
        own_(own_request(commander_stream(law, name), RegionKind::commander, {}, {}, lock_)) {
    lock_.keep_file();
  }

  /// Makes a request.
  void give(Time time, double rate, Time ramp, Time dead_man = {}) {
    command_ = {.number = command_.number + 1,
                .time = time,
                .rate = rate,
                .ramp = ramp,
                .dead_man = dead_man,
                .dead_man_ramp = kRamp};
    write_command(own_.control, command_);
  }

  void renew(Time time) {
    command_.time = time;
    write_command(own_.control, command_);
  }

  /// Overwrites a word of the record, as a faulty process could.
  void overwrite(std::size_t word, Word by) {
    store(own_.control[kCommanderNumber + word], by, std::memory_order_release);
  }

  /// Leaves the record as a process does that dies while it writes.
  void tear() {
    Word& sequence = own_.control[kCommanderSequence];
    store(sequence, load(sequence, std::memory_order_relaxed) + 1, std::memory_order_release);
  }

  static constexpr Time kRamp = milliseconds(70);  ///< of its dead man

 private:
  OwnerLock lock_;
  OwnedRequest own_;
  RateCommand command_;
};

/// The commanders of a law that no process solves, at times that the test chooses.
class LawCommanders : public ::testing::Test {
 protected:
  /// The least rate that is requested.
  double read(Time now, double largest = 1) {
    watch_.poll();
    commanders_.poll();
    commanders_.read(now);
    return least_rate(commanders_.states(), largest);
  }
  /// What the first commander asks of a law.
  core::RateRequest request() { return commanders_.states().front().request(1); }
  TestStream law_;
  RegionWatch watch_;
  Commanders commanders_{law_.name(), {}, watch_};
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
  one.give(seconds(1), 0.5, milliseconds(100));
  two.give(seconds(2), 0.25, milliseconds(200));
  EXPECT_EQ(read(seconds(3)), 0.25);
  EXPECT_FALSE(commanders_.calls());
  two.give(seconds(4), -1, milliseconds(400));
  EXPECT_TRUE(commanders_.calls());
  EXPECT_EQ(read(seconds(5)), 0.5);
}

TEST_F(LawCommanders, OnlyTheNewestCommandOfACommanderCounts) {
  AnyCommander one(law_.name(), "one");
  for (int i = 1; i <= 1000; ++i) one.give(seconds(i), 1.0 / i, milliseconds(100));
  EXPECT_EQ(read(seconds(2000)), 1.0 / 1000);
}

TEST_F(LawCommanders, ADeadManExpiresUnlessItsRequestIsRenewed) {
  AnyCommander one(law_.name(), "one");
  EXPECT_EQ(commanders_.next_expiry(), Time::max());
  one.give(seconds(1), 0.5, milliseconds(100), seconds(2));
  EXPECT_EQ(read(seconds(3) - Time(1)), 0.5);
  EXPECT_EQ(commanders_.next_expiry(), seconds(3));
  one.renew(seconds(2));
  EXPECT_EQ(read(seconds(3)), 0.5);
  EXPECT_EQ(commanders_.next_expiry(), seconds(4));
  EXPECT_EQ(read(seconds(4)), 0);
  EXPECT_TRUE(commanders_.states().front().is_dead);
  EXPECT_EQ(request().ramp, AnyCommander::kRamp);
  EXPECT_EQ(commanders_.next_expiry(), Time::max());
  one.give(seconds(5), -1, milliseconds(100), seconds(2));
  EXPECT_EQ(read(seconds(100)), 1) << "a withdrawn request does not expire";
}

TEST_F(LawCommanders, OnlyANewRequestEndsAnExpiredDeadMan) {
  AnyCommander one(law_.name(), "one");
  one.give(seconds(1), 0.5, milliseconds(100), seconds(2));
  EXPECT_EQ(read(seconds(3)), 0);
  one.renew(seconds(4));
  EXPECT_EQ(read(seconds(4)), 0);
  one.give(seconds(5), 0.5, milliseconds(100), seconds(2));
  EXPECT_EQ(read(seconds(5)), 0.5);
}

TEST_F(LawCommanders, ADamagedRecordLeavesTheLastGoodOneForTwentyMilliseconds) {
  constexpr Word kNotANumber = 0x7ff8000000000000;
  constexpr Word kHuge = Word{1} << 62;
  constexpr std::array<std::pair<std::size_t, Word>, 10> kDamages{{{0, 0},
                                                                   {1, kHuge},
                                                                   {1, ~kHuge},
                                                                   {2, kNotANumber},
                                                                   {2, std::bit_cast<Word>(101.0)},
                                                                   {2, std::bit_cast<Word>(-0.5)},
                                                                   {3, 0},
                                                                   {3, kHuge},
                                                                   {4, 1},
                                                                   {5, kHuge}}};
  AnyCommander one(law_.name(), "one");
  Time now{};
  for (const auto& [word, value] : kDamages) {
    now += seconds(1);
    one.give(now, 0.5, milliseconds(100));
    EXPECT_EQ(read(now), 0.5);
    one.overwrite(word, value);
    now += milliseconds(1);
    EXPECT_EQ(read(now), 0.5) << value << " as word " << word;
    EXPECT_EQ(commanders_.next_expiry(), now + milliseconds(20));
    EXPECT_EQ(read(now + milliseconds(20) - Time(1)), 0.5);
    EXPECT_EQ(request().ramp, milliseconds(100));
    now += milliseconds(20);
    EXPECT_EQ(read(now), 0);
    EXPECT_EQ(request().ramp, AnyCommander::kRamp);
    EXPECT_TRUE(commanders_.states().front().is_damaged);
    EXPECT_EQ(commanders_.next_expiry(), Time::max());
  }
}

TEST_F(LawCommanders, ARequestThatIsNeverCompletedHolds) {
  AnyCommander one(law_.name(), "one");
  one.tear();
  EXPECT_EQ(read(seconds(1)), 1);
  EXPECT_FALSE(commanders_.calls()) << "a torn record does not keep the solver awake";
  EXPECT_EQ(read(seconds(1) + milliseconds(20)), 0);
  EXPECT_EQ(request().ramp, kDeadManRamp) << "no ramp of a dead man is known";
  one.give(seconds(2), 0.25, milliseconds(100));
  EXPECT_EQ(read(seconds(2)), 0.25);
}

TEST_F(LawCommanders, ARequestOfAProcessThatDiedWhileItMadeItIsNotRenewed) {
  {
    AnyCommander one(law_.name(), "one");
    one.give(MonotonicClock().now(), 0.5, milliseconds(100));
    one.tear();
  }
  RateCommander successor(law_.name(), "one");
  successor.renew();
  EXPECT_EQ(read(MonotonicClock().now()), 1) << "no good record has been seen";
  EXPECT_EQ(read(MonotonicClock().now() + milliseconds(20)), 0);
  successor.set_rate(0.75, milliseconds(100));
  EXPECT_EQ(read(MonotonicClock().now()), 0.75);
  EXPECT_EQ(commanders_.states().front().command.number, 2U);
}

TEST_F(LawCommanders, ARequestThatNoProcessCanFindIsReported) {
  RateCommander panel(law_.name(), "panel");
  panel.set_rate(0.5, milliseconds(100));
  unlink_region(commander_stream(law_.name(), "panel"), RegionKind::commander);
  EXPECT_THROW(panel.hold(milliseconds(100)), BadRegion);
  EXPECT_THROW(panel.renew(), BadRegion);
}

TEST_F(LawCommanders, ACommanderThatEndedIsRemembered) {
  {
    RateCommander panel(law_.name(), "panel");
    panel.set_rate(0.25, milliseconds(50));
  }
  EXPECT_EQ(read(MonotonicClock().now()), 0.25);
  // Its successor requests nothing of its own yet.
  RateCommander panel(law_.name(), "panel");
  EXPECT_EQ(read(MonotonicClock().now()), 0.25);
  panel.release(milliseconds(50));
  EXPECT_EQ(read(MonotonicClock().now()), 1);
}

/// With layout version 6 a commander had a ring.
TEST_F(LawCommanders, RemovingTheLawRemovesRingsOfAnEarlierVersion) {
  const std::string old = commander_stream(law_.name(), "old");
  RegionHeader header = blank_header(7, true);
  header.mark.version = 6;
  header.kind = static_cast<std::uint64_t>(RegionKind::waypoints);
  Region region = Region::create(kBodyOffset, {});
  write_header(region.bytes(), header);
  ASSERT_TRUE(region.link(old, RegionKind::waypoints));
  remove_stream(law_.name());
  EXPECT_FALSE(region_exists(old, RegionKind::waypoints));
}

}  // namespace
}  // namespace splinecast::ipc
