#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <string>
#include <thread>
#include <vector>

#include "ipc/layout/knot_slots.hpp"
#include "ipc/owned/outcome.hpp"
#include "tests/fixtures/streams/watched_stream.hpp"

/// What became of each item of a live stream.
namespace splinecast::ipc::entries {
namespace {

/// A stream and the outcomes of its items.
struct Asked : Watched {
  using Watched::Watched;

  [[nodiscard]] ItemOutcome of(Word item) const {
    return outcome_of(board.reader, ring.reader, item);
  }
  [[nodiscard]] std::string text(Word item) const { return to_string(of(item)); }
  [[nodiscard]] Word last() const { return ring.reader.written() - 1; }
  void replace_by(int ms, const std::vector<int>& times) {
    std::vector<double> positions;
    for (const int at_ms : times) positions.push_back(motion(at(at_ms)));
    std::vector<Waypoint> plan;
    for (std::size_t i = 0; i < times.size(); ++i) {
      plan.push_back({.time = at(times[i]), .position = {&positions[i], 1}});
    }
    ASSERT_EQ(ring.writer.replace_from(at(ms), plan, solved()), AppendStatus::accepted);
  }
  /// The number of items from `first` to `last` with this outcome.
  [[nodiscard]] std::size_t count(OutcomeKind kind, Word first, Word last) const {
    std::size_t found = 0;
    for (Word item = first; item <= last; ++item) found += of(item).kind == kind ? 1U : 0U;
    return found;
  }
  /// Expects each waypoint that is in force to be a knot of the curve at that time, and the others
  /// not to be.
  void expect_true(Word first_item) {
    for (std::size_t i = 0; i < sent.size(); ++i) {
      const ItemOutcome found = of(first_item + i);
      const bool is_in_force = found.kind == OutcomeKind::in_force;
      EXPECT_TRUE(is_known(found)) << i;
      EXPECT_TRUE(found.is_final) << i;
      EXPECT_EQ(is_in_force, is_met(sent[i]) || ends_at(sent[i])) << i << to_string(found);
    }
  }
};

std::string in_force(int ms, const char* way) {
  return "in force at " + std::to_string(at(ms).count()) + " ns: " + way;
}

TEST(ItemOutcomes, OfAWaypointOnTheSplineNeedsNoRecord) {
  Asked live(limited(100));
  const auto send = [&](int ms) {
    live.send(ms, 0.2 - 0.2 * std::cos(0.01 * (ms - 50)));
  };  // to rest
  send(50);
  EXPECT_EQ(live.of(0).kind, OutcomeKind::waiting);
  for (int ms = 60; ms <= 364; ms += 10) send(ms);
  send(364);
  EXPECT_EQ(live.text(100), "waiting");
  live.drain();
  EXPECT_EQ(live.text(3), in_force(80, "spline"));
  EXPECT_FALSE(live.of(3).is_final);
  live.run_to(300);
  EXPECT_TRUE(live.of(3).is_final);
  EXPECT_FALSE(live.of(30).is_final);
  EXPECT_EQ(live.solver.summary().outcomes, 0U);
  live.end();
  EXPECT_EQ(live.solver.summary().outcomes, 1U);  // of the finish
  EXPECT_EQ(live.text(live.last()), in_force(364, "end"));
  live.expect_true(0);
}

TEST(ItemOutcomes, OfAStartByAnEntryArePassedOverUpToItsEnd) {
  Asked live(limited(5));
  for (int ms = 300; ms <= 2000; ms += 10) {
    live.run_to(ms - 300);
    live.send(ms, 1e-3 * ms);  // 1 /s from the start
  }
  live.step();
  const Word over = live.solver.summary().passed_over;
  ASSERT_GT(over, 0U);
  EXPECT_EQ(live.count(OutcomeKind::passed_over, 0, live.last()), over);
  EXPECT_EQ(live.text(0), in_force(300, "spline"));
  EXPECT_EQ(live.text(1), "passed over");
  EXPECT_EQ(live.of(1 + over).way, OutcomeWay::entry);
  EXPECT_EQ(live.of(2 + over).way, OutcomeWay::spline);
  live.end();
  live.expect_true(0);
}

TEST(ItemOutcomes, OfWaypointsThatCameLateAreUndecidedUntilTheCurveMeetsOne) {
  Asked live;
  live.send_all(50, 300, 100);
  live.run_to(320);
  const Word first = live.ring.reader.written();
  live.send(330);  // the newest knot has settled
  live.step();
  bool was_undecided = live.of(first).kind == OutcomeKind::undecided;
  live.send_all(340, 700, 10);
  for (Word item = first; item < live.last(); ++item) {
    was_undecided = was_undecided || live.of(item).kind == OutcomeKind::undecided;
  }
  EXPECT_TRUE(was_undecided);
  live.end();
  EXPECT_GT(live.count(OutcomeKind::passed_over, first, live.last()), 0U);
  live.expect_true(0);
}

TEST(ItemOutcomes, OfAReplacementAndOfWhatItTakesThePlaceOf) {
  Asked live;
  for (int ms = 50; ms <= 600; ms += 10) live.send(ms);
  live.drain();
  live.run_to(100);
  live.replace_by(300, {320, 340, 360, 380});
  live.drain();
  const Word replacement = live.last() - 4;
  EXPECT_EQ(live.text(replacement), in_force(300, "entry"));
  EXPECT_EQ(live.text(25), in_force(300, "spline"));
  EXPECT_EQ(live.text(26), "withdrawn");
  EXPECT_EQ(live.text(replacement - 1), "withdrawn");
  EXPECT_EQ(live.count(OutcomeKind::withdrawn, 0, replacement), 30U);
  live.run_to(700);
  EXPECT_EQ(live.count(OutcomeKind::undecided, 0, live.last()), 0U);
  const std::size_t met = live.count(OutcomeKind::in_force, replacement + 1, live.last());
  const std::size_t over = live.count(OutcomeKind::passed_over, replacement + 1, live.last());
  EXPECT_EQ(met + over, 4U);
  EXPECT_GE(met, 1U);
}

TEST(ItemOutcomes, OfALateReplacementSayWhenItTookEffect) {
  Asked live;
  for (int ms = 50; ms <= 600; ms += 10) live.send(ms);
  live.drain();
  live.run_to(100);
  live.replace_by(120, {130, 150, 170, 250, 270});
  live.clock.time = at(150);
  live.drain();
  const Word replacement = live.last() - 5;
  const ItemOutcome found = live.of(replacement);
  ASSERT_TRUE(found.time.has_value());
  EXPECT_GE(*found.time, at(150));
  EXPECT_EQ(found.way, OutcomeWay::entry);
  live.run_to(400);
  EXPECT_EQ(live.text(replacement + 1), "passed over");
  EXPECT_EQ(live.of(live.last()).kind, OutcomeKind::in_force);
}

TEST(ItemOutcomes, OfAStopAndOfWhatItWithdrawsUnread) {
  Asked live;
  live.send_all(50, 300, 100);
  live.replace_by(5000, {5100});
  const Word later = live.last() - 1;
  for (int ms = 5200; ms <= 5400; ms += 10) live.send(ms);
  ASSERT_EQ(live.ring.writer.replace_from(at(250), {}, live.solved()), AppendStatus::accepted);
  live.drain();
  EXPECT_EQ(live.text(live.last()), in_force(250, "stop"));
  for (Word item = later; item < live.last(); ++item) {
    EXPECT_EQ(live.text(item), "withdrawn") << item;
  }
  EXPECT_EQ(live.text(21), "withdrawn");  // on the curve until then
  EXPECT_EQ(live.text(20), in_force(250, "spline"));
}

TEST(ItemOutcomes, OfAReplacementInTheFutureAreWithdrawnWithWhatItHadKept) {
  for (const bool takes_over : {false, true}) {
    Asked live;
    for (int ms = 50; ms <= 600; ms += 10) live.send(ms);
    live.drain();
    live.replace_by(400, {420, 440, 460, 480, 500});
    live.drain();
    const Word first = live.last() - 5;
    ASSERT_EQ(live.text(first), in_force(400, "entry"));
    if (takes_over) live.replace_solver();
    live.replace_by(200, {240, 280, 320, 360});
    live.drain();
    EXPECT_EQ(live.text(first), "withdrawn");
    EXPECT_EQ(live.text(30), takes_over ? "forgotten" : "withdrawn");  // at 350 ms
    EXPECT_EQ(live.text(50), "withdrawn");
    EXPECT_EQ(live.text(first + 6), in_force(200, "entry"));
  }
}

TEST(ItemOutcomes, OfAnEndThatSlowsDownAreLaterThanTheirTimes) {
  core::WindowOptions how = limited(3);
  Asked live(how);
  for (int ms = 100; ms <= 900; ms += 10) live.send(ms, 0.5 * (1 - std::cos(2e-3 * (ms - 100))));
  live.drain();
  live.run_to(300);
  live.end();
  ASSERT_EQ(live.ending(), EndKind::slowed);
  const Word finish = live.last();
  const ItemOutcome newest = live.of(finish - 1);
  EXPECT_EQ(newest.way, OutcomeWay::end);
  EXPECT_GT(*newest.time, at(900));
  EXPECT_EQ(newest.time, live.of(finish).time);
  Time before = *newest.time;
  std::size_t slowed = 0;
  for (Word item = finish - 1; item-- > 0;) {
    const ItemOutcome found = live.of(item);
    ASSERT_EQ(found.kind, OutcomeKind::in_force);
    EXPECT_LT(*found.time, before);
    before = *found.time;
    if (found.way == OutcomeWay::end) ++slowed;
  }
  EXPECT_GT(slowed, 1U);
  live.expect_true(0);
}

TEST(ItemOutcomes, OfARefusedItemSayWhy) {
  Asked live;
  live.clock.time = at(200);
  live.send(50);
  live.drain();
  EXPECT_EQ(live.text(live.last()), "refused: past");
  EXPECT_TRUE(live.of(live.last()).is_final);
}

TEST(ItemOutcomes, AreForgottenIfAnotherSolverTookTheItem) {
  Asked live;
  for (int ms = 50; ms <= 400; ms += 10) live.send(ms);
  live.drain();
  live.replace_by(300, {320, 340, 360, 380});
  live.drain();
  const Word replacement = live.last() - 4;
  ASSERT_EQ(live.text(replacement), in_force(300, "entry"));
  live.replace_solver();
  for (int ms = 390; ms <= 500; ms += 10) live.send(ms);
  live.step();
  EXPECT_EQ(live.text(3), "forgotten");
  EXPECT_EQ(live.text(replacement), in_force(300, "entry"));  // there is a record
  EXPECT_EQ(live.text(live.last()), in_force(500, "spline"));
  live.end();
  EXPECT_EQ(live.of(live.last() - 1).kind, OutcomeKind::in_force);
}

TEST(ItemOutcomes, OlderThanWhatIsKeptAreForgotten) {
  Asked live({}, false);
  live.send_all(50, 100, 40);
  const Word waypoint = live.last();
  for (std::size_t i = 0; i < kOutcomesKept + 10; ++i) {
    const int ms = 120 + 10 * static_cast<int>(i);
    live.run_to(ms - 20);
    live.replace_by(ms, {ms + 30});
    live.step();
  }
  EXPECT_GT(live.solver.summary().outcomes, kOutcomesKept);
  EXPECT_EQ(live.text(waypoint), "forgotten");
  const Word newest = live.last() - 1;
  EXPECT_EQ(live.of(newest).kind, OutcomeKind::in_force);
  EXPECT_EQ(live.of(newest - 20).kind, OutcomeKind::in_force);
}

/// Each plan is withdrawn by the next one before its waypoint: its replacement is in force, and the
/// waypoint never. A thread reads the newest outcomes while the solver overwrites their records.
TEST(ItemOutcomes, AreKnownOrForgottenWhileTheirRecordsAreOverwritten) {
  constexpr int kPlans = 3000;
  Asked live;
  live.send_all(50, 100, 40);
  const Word first = live.last() + 1;
  std::atomic<Word> end = first;  // the outcomes of the items before this one are known
  std::atomic<bool> is_over = false;
  std::array<std::size_t, kOutcomeKinds> kinds{};
  std::size_t guesses = 0;
  std::thread reader([&] {
    while (!is_over) {
      const Word known = end;
      for (Word item = known - std::min<Word>(known - first, 300); item < known; ++item) {
        const ItemOutcome found = live.of(item);
        ++kinds[static_cast<std::size_t>(found.kind)];
        const bool is_plan = (item - first) % 2 == 0;
        const bool is_known =
            is_plan ? found.kind == OutcomeKind::in_force : found.kind == OutcomeKind::withdrawn;
        const bool is_right = is_known && (!is_plan || found.way == OutcomeWay::entry);
        guesses += is_right || found.kind == OutcomeKind::forgotten ? 0U : 1U;
      }
    }
  });
  for (int i = 0; i < kPlans; ++i) {
    const int ms = 120 + 10 * i;
    live.clock.time = at(ms - 20);
    live.replace_by(ms, {ms + 30});
    live.step();
    end = live.last() - 1;
  }
  is_over = true;
  reader.join();
  EXPECT_EQ(guesses, 0U);
  EXPECT_GT(kinds[static_cast<std::size_t>(OutcomeKind::in_force)], 0U);
  EXPECT_GT(kinds[static_cast<std::size_t>(OutcomeKind::withdrawn)], 0U);
  EXPECT_GT(kinds[static_cast<std::size_t>(OutcomeKind::forgotten)], 0U);
}

TEST(ItemOutcomes, AreThoseOfTheCommittedRevision) {
  Asked live;
  for (int ms = 50; ms <= 400; ms += 10) live.send(ms);
  live.drain();
  live.replace_by(200, {220, 240, 260});
  // The commit of the replacement comes too late: its revision is discarded.
  struct Late final : Clock {
    explicit Late(Time time) : first(time) {}
    [[nodiscard]] Time now() const noexcept override {
      return looks++ == 0 ? first : first + std::chrono::hours(1);
    }
    Time first;
    mutable int looks = 0;
  };
  const Late late(live.clock.time);
  ASSERT_TRUE(live.solver.step(late).missed);
  EXPECT_EQ(live.of(live.last() - 3).kind, OutcomeKind::waiting);
  EXPECT_EQ(live.text(30), in_force(350, "spline"));
  EXPECT_EQ(live.solver.summary().outcomes, 0U);
  live.drain();
  EXPECT_EQ(live.text(30), "withdrawn");
  EXPECT_EQ(live.text(live.last() - 3), in_force(200, "entry"));
}

}  // namespace
}  // namespace splinecast::ipc::entries
