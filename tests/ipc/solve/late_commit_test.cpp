#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <vector>

#include "ipc/solve/pauses.hpp"
#include "tests/fixtures/streams/live_stream.hpp"

namespace splinecast::ipc {
namespace {

using std::chrono::milliseconds;
using Live = testing::LiveStream;

/// The clock of a process that is stopped for `pause` after reading number `look`, counted from 1.
class StoppedClock final : public Clock {
 public:
  StoppedClock(Time now, int look, Time pause) : now_(now), look_(look), pause_(pause) {}
  [[nodiscard]] Time now() const noexcept override {
    return ++looks_ > look_ ? now_ + pause_ : now_;
  }

 private:
  Time now_;
  int look_;
  Time pause_;
  mutable int looks_ = 0;
};

/// A step reads the clock when it begins, directly before the commit, and after it.
constexpr int kBeforeCommit = 2;
constexpr Time kPause = milliseconds(50);

/// The counter as a reader sees it.
Word late_commits(const Live& live) {
  Summary summary;
  EXPECT_TRUE(live.board.reader.copy_summary(live.board.reader.look(), summary));
  return summary.late_commits;
}

/// The words that a solver stores after a commit, when it has read the clock.
std::span<Word> words_after_commit(Live& live) {
  return words_at(live.board.bytes.span(), live.board.layout.control, kChecked + 1).subspan(kLate);
}

/// A stream whose last commit was late.
struct LateCommit : Live {
  LateCommit() {
    put_all(50, 100);
    clock.time = kNow + milliseconds(80);
    EXPECT_EQ(put(kNow + milliseconds(110)), AppendStatus::accepted);
    before.assign(words_after_commit(*this).begin(), words_after_commit(*this).end());
    EXPECT_TRUE(solver.step(StoppedClock(clock.time, kBeforeCommit, kPause)).published);
    clock.time += kPause;
  }
  /// Simulates that the solver died after the commit and `stores` more stores. Starts a new solver.
  void die_after_commit(std::size_t stores) {
    std::ranges::copy(before.begin() + static_cast<std::ptrdiff_t>(stores), before.end(),
                      words_after_commit(*this).begin() + static_cast<std::ptrdiff_t>(stores));
    replace_solver();
  }
  std::vector<Word> before;
};

TEST(LateCommit, IsCountedAlsoIfNoRevisionFollows) {
  const LateCommit live;
  EXPECT_EQ(live.solver.summary().late_commits, 1U);
  EXPECT_EQ(late_commits(live), 1U);
}

TEST(LateCommit, IsCountedAlsoIfTheNextRevisionMissesItsDeadline) {
  LateCommit live;
  ASSERT_EQ(live.replace(live.solved().settled_until, {}), AppendStatus::accepted);
  EXPECT_TRUE(live.solver.step(StoppedClock(live.clock.time, 1, kPause)).missed);
  EXPECT_EQ(live.solver.summary().late_commits, 1U);
  live.clock.time += milliseconds(3);
  live.drain();
  EXPECT_EQ(live.solver.summary().deadline_misses, 1U);
  EXPECT_EQ(late_commits(live), 1U);
}

TEST(LateCommit, IsCountedOnceByTheNextSolverIfTheFirstDiesAfterIt) {
  for (const std::size_t stores : {0U, 1U, 2U}) {
    LateCommit live;
    live.die_after_commit(stores);
    live.solver.step(live.clock);
    EXPECT_EQ(late_commits(live), 1U) << stores;
    live.clock.time += milliseconds(3);
    live.solver.step(live.clock);
    live.replace_solver();
    live.clock.time += milliseconds(3);
    live.solver.step(live.clock);
    EXPECT_EQ(late_commits(live), 1U) << stores;
  }
}

TEST(LateCommit, IsNotCountedForATimelyCommitWhoseSolverDiesAfterIt) {
  Live live;
  live.put_all(50, 100);
  std::ranges::fill(words_after_commit(live), 0);
  live.replace_solver();
  live.clock.time += milliseconds(30);  // the published curve begins at 50 ms
  live.solver.step(live.clock);
  live.clock.time += milliseconds(100);
  live.solver.step(live.clock);
  EXPECT_EQ(late_commits(live), 0U);
}

TEST(Pauses, AreRememberedForOneToTwoSeconds) {
  const Time begin = std::chrono::hours(5);
  Pauses pauses;
  EXPECT_EQ(pauses.longest(begin), Time::zero());
  pauses.note(begin, milliseconds(30));
  pauses.note(begin + milliseconds(1), milliseconds(2));
  for (const int ms : {1, 500, 999, 1000, 1500, 1999}) {
    EXPECT_EQ(pauses.longest(begin + milliseconds(ms)), milliseconds(30)) << ms;
  }
  pauses.note(begin + milliseconds(1999), milliseconds(4));
  EXPECT_EQ(pauses.longest(begin + milliseconds(2500)), milliseconds(4));
  EXPECT_EQ(pauses.longest(begin + milliseconds(9000)), Time::zero());
}

TEST(Pauses, OfASolverAreOnTheBoard) {
  Live live;
  live.put_all(50, 800);
  for (int i = 0; i < 50; ++i, live.clock.time += milliseconds(1)) live.solver.step(live.clock);
  const auto longest = [&] { return live.solver.summary().longest_pause; };
  EXPECT_LT(longest(), milliseconds(3));
  live.clock.time += milliseconds(40);
  live.put_all(810, 820);
  EXPECT_GE(longest(), milliseconds(37));
  EXPECT_LE(longest(), milliseconds(42));
}

}  // namespace
}  // namespace splinecast::ipc
