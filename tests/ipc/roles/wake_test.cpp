#include <gtest/gtest.h>
#include <linux/futex.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <climits>
#include <thread>
#include <vector>

#include "ipc/board/reader.hpp"
#include "ipc/mapping/checked_region.hpp"
#include "ipc/memory/futex.hpp"
#include "splinecast/producer.hpp"
#include "splinecast/solver.hpp"
#include "tests/fixtures/processes/process.hpp"

namespace splinecast::ipc {
namespace {

/// Threads that only wait, once.
class Waiters {
 public:
  template <typename Wait>
  Waiters(std::size_t count, const Wait& wait) {
    std::vector<std::atomic<pid_t>> ids(count);
    for (auto& id : ids) {
      threads_.emplace_back([&id, wait] {
        id = gettid();
        wait();
      });
    }
    for (const auto& id : ids) {
      while (id == 0 || !testing::sleeps(id)) std::this_thread::yield();
    }
  }
  Waiters(const Waiters&) = delete;
  Waiters& operator=(const Waiters&) = delete;
  ~Waiters() {
    for (std::thread& thread : threads_) thread.join();
  }

 private:
  std::vector<std::thread> threads_;
};

/// Waits without waking other threads. The timeout prevents a hang if the test fails.
void park(const Word& word, Word seen) { wait_while_equal(word, seen, testing::kPatience); }

/// Wakes all parked threads. Returns their number.
int wake_rest(const Word& word) {
  return static_cast<int>(
      syscall(SYS_futex, &word, FUTEX_WAKE, INT_MAX, nullptr, nullptr, 0));  // NOLINT
}

TEST(Wake, WakesAFixedNumberOfParkedThreads) {
  constexpr int kParked = 100;
  alignas(8) Word word = 7;
  const Waiters waiters(kParked, [&word] { park(word, 7); });
  EXPECT_EQ(wake_some(word), kWokenAtOnce);
  EXPECT_EQ(wake_rest(word), kParked - kWokenAtOnce);
}

TEST(Wake, ReachesEveryThreadThatWaitsForAChange) {
  constexpr std::size_t kWaiting = 100;
  alignas(8) Word word = 7;
  std::atomic<std::size_t> woken{0};
  {
    const Waiters waiters(kWaiting, [&] {
      if (wait_for_change(word, 7, testing::kPatience)) ++woken;
    });
    store(word, 8, std::memory_order_release);
    EXPECT_EQ(wake_some(word), kWokenAtOnce);
  }
  EXPECT_EQ(woken, kWaiting);
}

TEST(Wake, IsNotForwardedByThreadsThatHaveSeenTheRevision) {
  constexpr std::size_t kWaiting = 20;
  alignas(8) Word word = 8;
  std::atomic<std::size_t> woken{0};
  const Waiters waiters(kWaiting, [&] {
    if (wait_for_change(word, 8, testing::kPatience)) ++woken;
  });
  EXPECT_EQ(wake_some(word), kWokenAtOnce);
  while (woken < kWokenAtOnce) std::this_thread::yield();
  EXPECT_EQ(wake_rest(word), static_cast<int>(kWaiting) - kWokenAtOnce);
}

TEST(Wake, AStepWakesAFixedNumberOfThreadsParkedOnItsBoard) {
  constexpr int kParked = 100;
  const testing::TestStream stream;
  Producer producer(stream.name(), {.dimensions = 1, .clock = StreamClock::recorded, .start = {}});
  Solver solver(stream.name(), {});
  ASSERT_TRUE(solver.attach());
  // A read-only mapping, as readers have one.
  const auto [region, header, layout] = open_board(stream.name(), false, {});
  const KnotBoardReader board(region.bytes(), layout);
  const Waiters waiters(kParked, [&board] { park(board.revision_word(), 0); });
  const double x = 1;
  ASSERT_EQ(producer.append({.time = {}, .position = std::span(&x, 1)}), AppendStatus::accepted);
  ASSERT_TRUE(solver.step(MonotonicClock()).published);
  EXPECT_EQ(wake_rest(board.revision_word()), kParked - kWokenAtOnce);
}

}  // namespace
}  // namespace splinecast::ipc
