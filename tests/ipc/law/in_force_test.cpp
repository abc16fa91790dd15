#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <fstream>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "ipc/law/law_board.hpp"
#include "ipc/layout/header.hpp"
#include "ipc/layout/request_control.hpp"
#include "ipc/mapping/region.hpp"
#include "ipc/memory/names.hpp"
#include "ipc/sweep/many_streams.hpp"
#include "splinecast/errors.hpp"
#include "tests/ipc/law/time_law.hpp"

/// What the board of a law shows of its commanders: which requests are in force, and what a
/// solver that takes over continues with.
namespace splinecast {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using testing::TimeLaw;

class InForce : public TimeLaw {
 protected:
  /// Kills the law's solver, and lets another one take over.
  void take_over() {
    law_solver_.reset();
    law_solver_.emplace(law_.name(), SolverOptions{});
    ASSERT_TRUE(law_solver_->attach(clock_));
  }
  double rate() {
    State state(1);
    EXPECT_TRUE(has_values(reader_->sample(clock_.now(), state)));
    return reader_->rate().rate;
  }
  std::vector<std::string> faults() {
    std::vector<std::string> reported;
    law_solver_->take_commander_faults(reported);
    return reported;
  }
  std::vector<ipc::CommanderEntry> commanders() {
    ipc::LawBoard board(law_.name(), {});
    EXPECT_TRUE(board.is_there());
    return board.commanders();
  }
};

TEST_F(InForce, ANewCommanderIsHeardAlthoughEndedOnesFillTheTable) {
  for (int i = 0; i < 40; ++i) {
    RateCommander brief(law_.name(), "brief" + std::to_string(i));
    brief.hold(milliseconds(1));
    pass(milliseconds(100));
    ASSERT_EQ(rate(), 0) << i;
    brief.release(milliseconds(1));
    pass(milliseconds(10));
    ASSERT_EQ(rate(), 1) << i;
  }
}

TEST_F(InForce, ARequestIsWhenItsRevisionIsCommitted) {
  const std::uint64_t number = operator_.hold(milliseconds(100));
  EXPECT_EQ(number, 2U);
  EXPECT_TRUE(operator_.wait_in_force(number - 1, Time::zero()));
  EXPECT_FALSE(operator_.wait_in_force(number, milliseconds(2)));
  pass(milliseconds(1));
  EXPECT_TRUE(operator_.wait_in_force(number, Time::zero()));
  EXPECT_FALSE(operator_.wait_in_force(number + 1, Time::zero()));
  EXPECT_GT(rate(), 0.9) << "in force is not reached";
}

TEST_F(InForce, ARequestIsAlsoIfItChangesNothing) {
  (void)operator_.hold(milliseconds(50));
  pass(milliseconds(100));
  const std::uint64_t number = operator_.hold(milliseconds(50));
  EXPECT_FALSE(operator_.wait_in_force(number, Time::zero()));
  pass(milliseconds(1));
  EXPECT_TRUE(operator_.wait_in_force(number, Time::zero()));
  RateCommander estop(law_.name(), "estop");
  const std::uint64_t release = estop.release(milliseconds(50));
  pass(milliseconds(30));
  EXPECT_TRUE(estop.wait_in_force(release, Time::zero()));
}

TEST_F(InForce, ARequestIsNotWhileTheRevisionIsLate) {
  const std::uint64_t number = operator_.hold(milliseconds(10));
  clock_.advance(milliseconds(1));
  clock_.pause_before(3, milliseconds(50));
  EXPECT_TRUE(law_solver_->step(clock_).missed);
  EXPECT_FALSE(operator_.wait_in_force(number, Time::zero()));
  pass(milliseconds(1));
  EXPECT_TRUE(operator_.wait_in_force(number, Time::zero()));
  pass(milliseconds(30));
  EXPECT_EQ(rate(), 0);
}

TEST_F(InForce, NoRequestIsWithoutASolver) {
  const testing::TestStream law;
  RateCommander commander(law.name(), "operator");
  EXPECT_FALSE(commander.wait_in_force(commander.hold(milliseconds(10)), milliseconds(3)));
}

TEST_F(InForce, TheBoardNamesItsCommanders) {
  RateCommander estop(law_.name(), "a-name-of-more-than-thirty-two-characters");
  (void)estop.set_rate(0.25, milliseconds(70));
  pass(milliseconds(200));
  const auto found = commanders();
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(ipc::name_of(found[0]), "operator");
  EXPECT_EQ(ipc::name_of(found[1]), std::string("a-name-of-more-than-thirty-two-characters", 32));
  EXPECT_EQ(found[1].number, 1U);
  EXPECT_EQ(found[1].ramp, milliseconds(70));
  EXPECT_EQ(found[1].bound.last_rate(), 0.25);
  EXPECT_TRUE(found[1].asks);
  EXPECT_FALSE(found[1].is_dead);
}

TEST_F(InForce, ADeadManThatHasFiredRemainsSoAfterATakeover) {
  operator_.set_dead_man(milliseconds(20), milliseconds(10));
  (void)operator_.set_rate(0.5, milliseconds(10));
  pass(milliseconds(100));
  EXPECT_EQ(rate(), 0);
  EXPECT_TRUE(commanders().front().is_dead);
  EXPECT_FALSE(operator_.renew());
  // A renewal that was written before the process could know, and a takeover after it.
  std::optional<ipc::CommanderEntry> before = commanders().front();
  take_over();
  pass(milliseconds(100));
  EXPECT_EQ(rate(), 0);
  EXPECT_TRUE(commanders().front().is_dead);
  EXPECT_EQ(commanders().front().number, before->number);
  operator_.set_dead_man(Time::zero());
  (void)operator_.set_rate(0.5, milliseconds(10));
  EXPECT_TRUE(operator_.renew());
  pass(milliseconds(50));
  EXPECT_EQ(rate(), 0.5);
}

TEST_F(InForce, ASuccessorKeepsTheBoundOfARampThatRuns) {
  // The operator rises slowly while the estop holds the rate down: when that releases it, the rate
  // follows the operator's ramp.
  (void)operator_.set_rate(0.2, milliseconds(10));
  pass(milliseconds(50));
  RateCommander estop(law_.name(), "estop");
  (void)estop.set_rate(0.1, milliseconds(50));
  (void)operator_.set_rate(1, seconds(4));
  pass(seconds(2));
  EXPECT_NEAR(commanders().front().bound.at(clock_.now()).rate, 0.6, 0.01);
  take_over();
  (void)estop.release(milliseconds(20));
  watch(seconds(4), [&](const State&, SampleStatus) {
    ASSERT_LE(reader_->rate().rate, commanders().front().bound.at(clock_.now()).rate + 1e-9);
  });
  EXPECT_EQ(rate(), 1);
}

TEST_F(InForce, ASuccessorWithAnotherLargestRateIsRefused) {
  law_solver_.reset();
  SolverOptions options;
  options.largest_rate = 2;
  EXPECT_THROW((void)Solver(law_.name(), options).attach(clock_), BadRequest);
  options.largest_rate = 1;
  EXPECT_TRUE(Solver(law_.name(), options).attach(clock_));
}

TEST_F(InForce, TheSeventeenthCommanderIsRefusedUntilOneIsForgotten) {
  std::vector<std::optional<RateCommander>> all(15);
  for (std::size_t i = 0; i < all.size(); ++i) {
    all[i].emplace(law_.name(), "c" + std::to_string(i));
    (void)all[i]->set_rate(1, milliseconds(10));
  }
  pass(milliseconds(50));
  EXPECT_EQ(commanders().size(), 16U);
  try {
    const RateCommander more(law_.name(), "more");
    FAIL() << "a 17th commander";
  } catch (const OutOfResources& error) {
    EXPECT_NE(std::string(error.what()).find("operator, c0, c1"), std::string::npos)
        << error.what();
  }
  EXPECT_FALSE(
      ipc::region_exists(ipc::commander_stream(law_.name(), "more"), ipc::RegionKind::commander));
  // A known one can come again.
  all[3].reset();
  all[3].emplace(law_.name(), "c3");
  // Only one whose process has gone is forgotten.
  (void)all[4]->release(milliseconds(10));
  pass(seconds(3));
  EXPECT_EQ(commanders().size(), 16U);
  all[4].reset();
  pass(seconds(3));
  EXPECT_EQ(commanders().size(), 15U);
  RateCommander more(law_.name(), "more");
  const std::uint64_t number = more.hold(milliseconds(10));
  pass(milliseconds(50));
  EXPECT_TRUE(more.wait_in_force(number, Time::zero()));
  EXPECT_EQ(rate(), 0);
}

TEST_F(InForce, ARateAboveTheLargestIsRefusedWhereTheLawIsKnown) {
  EXPECT_THROW((void)operator_.set_rate(1.5, milliseconds(10)), BadRequest);
  EXPECT_NO_THROW((void)operator_.set_rate(1, milliseconds(10)));
  const testing::TestStream law;
  RateCommander commander(law.name(), "operator");
  EXPECT_NO_THROW((void)commander.set_rate(1.5, milliseconds(10)));
}

TEST_F(InForce, ACommanderOfAnotherTimeNamespaceIsNotTaken) {
  std::optional<RateCommander> estop(std::in_place, law_.name(), "estop");
  (void)estop->hold(milliseconds(10));
  estop.reset();
  const std::string path =
      ipc::region_path(ipc::commander_stream(law_.name(), "estop"), ipc::RegionKind::commander);
  auto header = *ipc::peek_header(ipc::commander_stream(law_.name(), "estop"),
                                  ipc::RegionKind::commander, {});
  header.time_namespace += 1;
  std::array<std::byte, ipc::kHeaderBytes> bytes{};
  ipc::write_header(bytes, header);
  std::fstream(path, std::ios::in | std::ios::out | std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), bytes.size());  // NOLINT
  take_over();
  pass(milliseconds(200));
  EXPECT_EQ(rate(), 1);
  EXPECT_EQ(commanders().size(), 1U);
  const auto reported = faults();
  ASSERT_EQ(reported.size(), 1U);
  EXPECT_TRUE(reported[0].starts_with("commander 'estop' is not heard: ")) << reported[0];
  EXPECT_NE(reported[0].find("time namespace"), std::string::npos) << reported[0];
  pass(milliseconds(100));
  EXPECT_TRUE(faults().empty()) << "once";
}

TEST_F(InForce, ANewCommanderIsInForceAfterTheNextStepAndNotReported) {
  pass(milliseconds(50));
  EXPECT_TRUE(faults().empty());
  RateCommander panel(law_.name(), "panel");
  const auto request = panel.set_rate(0.5, milliseconds(10));
  (void)law_solver_->step(clock_);
  EXPECT_TRUE(panel.wait_in_force(request, Time::zero()));
  pass(milliseconds(100));
  EXPECT_EQ(rate(), 0.5);
  EXPECT_TRUE(faults().empty());
}

TEST_F(InForce, ADeadManThatHasFiredIsReported) {
  operator_.set_dead_man(milliseconds(20), milliseconds(10));
  (void)operator_.set_rate(0.5, milliseconds(10));
  pass(milliseconds(100));
  const std::vector<std::string> fired{
      "commander 'operator' counts as requesting rate 0 until its next request: its dead man has "
      "fired"};
  EXPECT_EQ(faults(), fired);
  operator_.set_dead_man(Time::zero());
  (void)operator_.set_rate(0.5, milliseconds(10));
  pass(milliseconds(100));
  EXPECT_TRUE(faults().empty());
  operator_.set_dead_man(milliseconds(20), milliseconds(10));
  (void)operator_.set_rate(0.5, milliseconds(10));
  pass(milliseconds(100));
  EXPECT_EQ(faults(), fired) << "again";
}

TEST_F(InForce, ADamagedRecordIsReportedAndCountsAsRateZero) {
  (void)operator_.set_rate(0.5, milliseconds(10));
  pass(milliseconds(50));
  EXPECT_TRUE(faults().empty());
  const std::string region = ipc::commander_stream(law_.name(), "operator");
  const auto header = ipc::peek_header(region, ipc::RegionKind::commander, {});
  ASSERT_TRUE(header);
  std::fstream file(ipc::region_path(region, ipc::RegionKind::commander),
                    std::ios::in | std::ios::out | std::ios::binary);
  const auto write = [&](std::size_t word, ipc::Word value) {
    file.seekp(static_cast<std::streamoff>(header->control + word * sizeof(value)))
        .write(reinterpret_cast<const char*>(&value), sizeof(value))  // NOLINT
        .flush();
  };
  ASSERT_TRUE(file);
  write(ipc::kCommanderNumber + 2,
        std::bit_cast<ipc::Word>(std::numeric_limits<double>::quiet_NaN()));
  write(ipc::kCommanderSequence, 1000);
  pass(milliseconds(10));
  EXPECT_EQ(rate(), 0.5);
  pass(seconds(1));
  EXPECT_EQ(rate(), 0);
  const std::vector<std::string> damaged{
      "commander 'operator' counts as requesting rate 0: its region holds no whole request"};
  EXPECT_EQ(faults(), damaged);
  (void)operator_.set_rate(0.5, milliseconds(10));
  pass(milliseconds(50));
  EXPECT_EQ(rate(), 0.5);
}

TEST(CommandersOfALaw, ANewOneIsInForceAfterTheNextSweep) {
  const testing::TestStream law;
  testing::HostClock clock;
  const RateCommander first(law.name(), "first");
  ipc::StreamSweep sweep({law.name()}, {}, [](auto&&...) {});
  const auto step = [&] {
    clock.advance(milliseconds(1));
    (void)sweep.sweep(clock);
  };
  for (int i = 0; i < 200; ++i) step();
  RateCommander panel(law.name(), "panel");
  const auto request = panel.set_rate(0.5, milliseconds(10));
  step();
  EXPECT_TRUE(panel.wait_in_force(request, Time::zero()));
}

TEST(CommandersOfALaw, BeyondTheSixteenthAreReported) {
  const testing::TestStream law;
  testing::HostClock clock;
  std::vector<std::optional<RateCommander>> all(17);
  for (std::size_t i = 0; i < all.size(); ++i) {
    all[i].emplace(law.name(), std::string(1, static_cast<char>('a' + i)));
    (void)all[i]->set_rate(i == 2 ? 1.5 : 1, milliseconds(10));
  }
  Solver solver(law.name(), {});
  ASSERT_TRUE(solver.attach(clock));
  for (int i = 0; i < 100; ++i) {
    clock.advance(milliseconds(1));
    (void)solver.step(clock);
  }
  std::vector<std::string> reported;
  solver.take_commander_faults(reported);
  EXPECT_EQ(reported, (std::vector<std::string>{
                          "commander 'c' requests rate 1.5, which counts as the largest, 1",
                          "commander 'q' is not heard: the law has 16 others"}));
}

}  // namespace
}  // namespace splinecast
