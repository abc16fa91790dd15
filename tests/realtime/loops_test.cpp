#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <csignal>
#include <random>
#include <vector>

#include "ipc/roles/internals.hpp"
#include "splinecast/reader.hpp"
#include "splinecast/solver.hpp"
#include "tests/fixtures/processes/confined.hpp"
#include "tests/fixtures/processes/process.hpp"
#include "tests/realtime/sending.hpp"

/// The loops of reader, producer and solver in a process that is killed at its first system call.
namespace splinecast::testing {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t kDimensions = 7;
constexpr std::uint64_t kWarmUp = 2'000;
/// How long a stream that has just begun, or has starved, needs to reach its waypoints. Before
/// that, a horizon contains only some of the kinds of segments.
constexpr Time kWarmUpTime = 300ms;
constexpr std::uint64_t kRounds = 20'000;
constexpr std::size_t kHorizon = 40;  ///< times per horizon
const SolverOptions kSolving{.history = Time::zero(), .wake = false};

void expect_undisturbed(const ConfinedEnd& end) {
  EXPECT_EQ(end.signal, 0);
  EXPECT_EQ(end.code, 0);
  EXPECT_EQ(end.allocations, 0U);
  EXPECT_EQ(end.minor_faults, 0U);
  EXPECT_EQ(end.major_faults, 0U);
  ::testing::Test::RecordProperty("rounds", std::to_string(end.rounds));
  ::testing::Test::RecordProperty("answered", std::to_string(end.answered));
  ::testing::Test::RecordProperty("busy", std::to_string(end.busy));
  ::testing::Test::RecordProperty("killed", std::to_string(end.signal != 0 ? 1 : 0));
  ::testing::Test::RecordProperty("allocations", std::to_string(end.allocations));
  ::testing::Test::RecordProperty("minor_faults", std::to_string(end.minor_faults));
  ::testing::Test::RecordProperty("major_faults", std::to_string(end.major_faults));
}

/// Runs a loop as run_confined() does, and expects that nothing disturbed it. Runs it again if a
/// page fault occurred: on a busy machine the kernel moves pages, which causes one. A page fault of
/// the loop itself occurs in each run.
ConfinedEnd run_undisturbed(const std::function<void(Confined&)>& loop,
                            const std::function<void()>& meanwhile) {
  constexpr int kTries = 5;
  ConfinedEnd end;
  for (int i = 0; i < kTries; ++i) {
    end = run_confined(loop, meanwhile);
    if (end.minor_faults == 0) break;
  }
  expect_undisturbed(end);
  return end;
}

/// The live loops read CLOCK_MONOTONIC. The tests are skipped if this is a system call because the
/// kernel has no vDSO clock for this machine's clock source.
class RealTime : public ::testing::Test {
 protected:
  void SetUp() override {
    const ConfinedEnd end = run_confined([](Confined& process) {
      const MonotonicClock clock;
      (void)clock.now();
      process.confine();
      for (int i = 0; i < 1000; ++i) (void)clock.now();
      process.finish();
    });
    if (end.signal == SIGSYS) GTEST_SKIP() << "CLOCK_MONOTONIC is a system call on this machine";
    ASSERT_EQ(end.code, 0);
  }
};

/// Samples at now and at random times around it, and sometimes a whole horizon.
class RandomSampling {
 public:
  RandomSampling(const std::string& stream, ConfinedPage& page)
      : page_(page), reader_(stream, kPatience), values_(kHorizon * state_.values().size()) {}

  void round() {
    const Time now = clock_.now();
    const Time jump = Sending::kInterval * (static_cast<std::int64_t>(random_() % 4000) - 2000);
    const SampleStatus status =
        random_() % 4 == 0 ? reader_.preview(now + jump, state_) : reader_.sample(now, state_);
    if (has_values(status)) ++page_.answered;
    if (status == SampleStatus::busy) ++page_.busy;
    if (random_() % 16 == 0) look_ahead(now);
    ++page_.rounds;
  }

 private:
  void look_ahead(Time now) {
    for (std::size_t i = 0; i < kHorizon; ++i) {
      times_[i] = now + static_cast<std::int64_t>(i) * Sending::kInterval / 2;
    }
    (void)ipc::Internals::sampler(reader_).sample_many(times_,
                                                       {.values = values_, .status = statuses_});
  }

  ConfinedPage& page_;
  MonotonicClock clock_;
  Reader reader_;
  State state_{kDimensions};
  std::mt19937_64 random_{1};
  std::array<Time, kHorizon> times_{};
  std::array<SampleStatus, kHorizon> statuses_{};
  std::vector<double> values_;
};

TEST_F(RealTime, SamplingMakesNoSystemCallNoAllocationAndNoPageFault) {
  const TestStream stream;
  Sending sending(stream.name(), kDimensions);
  Solver solver(stream.name(), kSolving);
  ASSERT_TRUE(solver.attach());
  const MonotonicClock clock;
  const auto work = [&] {
    sending.send();
    solver.step(clock);
  };
  for (int i = 0; i < 200; ++i) work();
  const ConfinedEnd end = run_undisturbed(
      [&](Confined& process) {
        RandomSampling sampling(stream.name(), process.page());
        for (const Time warm = clock.now() + kWarmUpTime; clock.now() < warm;) sampling.round();
        process.page().rounds = process.page().answered = process.page().busy = 0;
        process.confine();
        for (std::uint64_t i = 0; i < 10 * kRounds; ++i) sampling.round();
        process.finish();
      },
      work);
  EXPECT_EQ(end.rounds, 10 * kRounds);
  EXPECT_GT(end.answered, end.rounds / 2);
}

TEST_F(RealTime, AppendingMakesNoSystemCallNoAllocationAndNoPageFault) {
  const TestStream stream;
  Solver solver(stream.name(), kSolving);
  const MonotonicClock clock;
  const ConfinedEnd end = run_undisturbed(
      [&](Confined& process) {
        Sending sending(stream.name(), kDimensions);
        if (!sending.producer().wait_for_solver(kPatience)) _exit(1);
        const auto send = [&](std::uint64_t waypoints) {
          for (std::uint64_t sent = 0; sent < waypoints;) {
            if (sending.send()) ++sent;
            ++process.page().rounds;
          }
        };
        send(kWarmUp);
        process.page().rounds = 0;
        process.confine();
        send(kRounds);
        process.page().answered = kRounds;
        process.finish();
      },
      [&] {
        solver.attach();
        solver.step(clock);
      });
  EXPECT_EQ(end.answered, kRounds);
}

TEST_F(RealTime, SolvingMakesNoSystemCallNoAllocationAndNoPageFault) {
  const TestStream stream;
  Sending sending(stream.name(), kDimensions);
  const MonotonicClock clock;
  const ConfinedEnd end = run_undisturbed(
      [&](Confined& process) {
        Solver solver(stream.name(), kSolving);
        if (!solver.attach()) _exit(1);
        const auto solve = [&](std::uint64_t waypoints) {
          const ipc::Word enough = ipc::Internals::summary(solver).knots + waypoints;
          while (ipc::Internals::summary(solver).knots < enough) {
            if (solver.step(clock).published) ++process.page().answered;
            ++process.page().rounds;
          }
        };
        solve(kWarmUp);
        process.page().rounds = process.page().answered = 0;
        process.confine();
        solve(kRounds);
        process.finish();
      },
      [&] { sending.send(); });
  EXPECT_GT(end.answered, 0U);
}

TEST_F(RealTime, ASolverThatWakesReadersMakesASystemCall) {
  const TestStream stream;
  Sending sending(stream.name(), kDimensions);
  const ConfinedEnd end = run_confined(
      [&](Confined& process) {
        SolverOptions waking = kSolving;
        waking.wake = true;
        Solver solver(stream.name(), waking);
        if (!solver.attach()) _exit(1);
        const MonotonicClock clock;
        process.confine();
        for (;;) solver.step(clock);
      },
      [&] { sending.send(); });
  EXPECT_EQ(end.signal, SIGSYS);
}

TEST(Confined, ASystemCallKillsTheProcess) {
  const ConfinedEnd end = run_confined([](Confined& process) {
    process.confine();
    (void)syscall(SYS_getpid);
    process.finish();
  });
  EXPECT_EQ(end.signal, SIGSYS);
}

TEST(Confined, AllocationsAndPageFaultsAreCounted) {
  constexpr std::size_t kBytes = 64 * ipc::kPage;
  const ConfinedEnd end = run_confined([](Confined& process) {
    auto* const pages = static_cast<volatile char*>(
        mmap(nullptr, kBytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0));
    madvise(const_cast<char*>(pages), kBytes, MADV_NOHUGEPAGE);
    { const std::vector<int> first(100, 1); }  // the heap then has memory for the next one
    process.confine();
    for (std::size_t at = 0; at < kBytes; at += ipc::kPage) pages[at] = 1;
    { const std::vector<int> second(100, pages[0]); }
    process.finish();
  });
  EXPECT_EQ(end.code, 0);
  EXPECT_EQ(end.allocations, 1U);
  EXPECT_GE(end.minor_faults, 64U);
}

}  // namespace
}  // namespace splinecast::testing
