#include <gtest/gtest.h>
#include <sched.h>
#include <sys/timerfd.h>
#include <unistd.h>

#include <chrono>
#include <cstdint>
#include <ctime>
#include <limits>
#include <random>

#include "ipc/board/reader.hpp"
#include "ipc/layout/check.hpp"
#include "ipc/layout/header.hpp"
#include "ipc/layout/knot_slots.hpp"
#include "ipc/layout/publication.hpp"
#include "ipc/layout/summary.hpp"
#include "ipc/mapping/region.hpp"
#include "ipc/roles/internals.hpp"
#include "splinecast/reader.hpp"
#include "splinecast/solver.hpp"
#include "tests/fixtures/processes/confined.hpp"
#include "tests/fixtures/processes/process.hpp"
#include "tests/realtime/sending.hpp"

/// A reader on the writer's core with a higher priority: while it samples, the writer stays
/// preempted. A reader that waited for the writer would wait forever.
namespace splinecast::testing {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t kDimensions = 64;  // most of a revision's time is its publication
constexpr int kPriority = 10;
constexpr int kBurst = 50;                             // samples per preemption
constexpr std::uint64_t kMidway = 200;                 // preemptions within a publication, at least
constexpr std::uint64_t kPreemptions = 1000;           // preemptions in all, at least
constexpr std::int64_t kMostCpuPerSample = 1'000'000;  // ns; a sample takes less than 1000
constexpr int kForbidden = 77;

/// Keeps this process and the processes that it forks on one core.
class OneCore {
 public:
  OneCore() {
    sched_getaffinity(0, sizeof before_, &before_);
    cpu_set_t one;
    CPU_ZERO(&one);
    CPU_SET(static_cast<std::size_t>(sched_getcpu()), &one);
    sched_setaffinity(0, sizeof one, &one);
  }
  OneCore(const OneCore&) = delete;
  OneCore& operator=(const OneCore&) = delete;
  ~OneCore() { sched_setaffinity(0, sizeof before_, &before_); }

 private:
  cpu_set_t before_{};
};

/// A timer whose waits have random lengths, so that the writer is preempted at any point.
class Alarm {
 public:
  void wait() {
    itimerspec when{};
    when.it_value.tv_nsec = 50'000 + static_cast<std::int64_t>(random_() % 400'000);
    timerfd_settime(timer_, 0, &when, nullptr);
    std::uint64_t expirations = 0;
    (void)!read(timer_, &expirations, sizeof expirations);
  }

 private:
  int timer_ = timerfd_create(CLOCK_MONOTONIC, TFD_CLOEXEC);
  std::mt19937_64 random_{1};
};

/// Detects whether a stream's writer is between the first store of a revision and its commit.
class PublicationWatch {
 public:
  explicit PublicationWatch(const std::string& stream)
      : region_(ipc::Region::open(stream, ipc::RegionKind::spline, false)),
        layout_(
            ipc::checked_board_layout(ipc::copy_header(region_.bytes()), region_.bytes().size())),
        board_(region_.bytes(), layout_) {}

  [[nodiscard]] ipc::Word revision() const { return board_.revision(); }

  [[nodiscard]] bool is_midway() {
    const ipc::Look look = board_.look();
    const ipc::Word r = look.revision;
    if (r == 0 || !board_.copy_bounds(look, r, summary_)) return false;
    const ipc::Word first = summary_.newest > kChanged ? summary_.newest - kChanged : 1;
    for (ipc::Word number = first; number <= summary_.newest + 1; ++number) {
      const auto words = ipc::words_at(std::span<const std::byte>(region_.bytes()),
                                       layout_.slots + (number % layout_.capacity) * layout_.stride,
                                       layout_.stride / sizeof(ipc::Word));
      const ipc::SlotView<const ipc::Word> slot{words.data(), layout_.cell / sizeof(ipc::Word)};
      for (const ipc::Word tag : slot.tags(std::memory_order_relaxed).of) {
        if (ipc::revision_of(tag) == r + 1) return true;
      }
    }
    return false;
  }

 private:
  static constexpr ipc::Word kChanged = 16;  ///< newest knots that a revision may change

  ipc::Region region_;
  ipc::BoardLayout layout_;
  ipc::KnotBoardReader board_;
  ipc::Summary summary_;
};

std::int64_t cpu_time() {
  timespec used{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &used);
  return std::int64_t{used.tv_sec} * 1'000'000'000 + used.tv_nsec;
}

void read_above(const std::string& stream, Confined& process) {
  Reader reader(stream, kPatience);
  PublicationWatch watch(stream);
  const MonotonicClock clock;
  State state(kDimensions);
  Alarm alarm;
  const sched_param above{.sched_priority = kPriority};
  if (sched_setscheduler(0, SCHED_FIFO, &above) != 0) _exit(kForbidden);
  ConfinedPage& page = process.page();
  while (page.midway < kMidway || page.rounds < kPreemptions * kBurst) {
    alarm.wait();
    const ipc::Word revision = watch.revision();
    if (watch.is_midway()) ++page.midway;
    const std::int64_t before = cpu_time();
    for (int i = 0; i < kBurst; ++i) {
      const SampleStatus status = reader.sample(clock.now(), state);
      if (has_values(status)) ++page.answered;
      if (status == SampleStatus::busy) ++page.busy;
      ++page.rounds;
    }
    page.cpu_ns += static_cast<std::uint64_t>(cpu_time() - before);
    if (watch.revision() != revision) ++page.overtaken;
  }
  process.finish();
}

TEST(PreemptedWriter, AReaderOfHigherPriorityOnTheSameCoreNeverWaitsForTheWriter) {
  const TestStream stream;
  const OneCore core;
  Sending sending(stream.name(), kDimensions);
  Solver solver(stream.name(), {.history = Time::zero(), .wake = false});
  ASSERT_TRUE(solver.attach());
  const MonotonicClock clock;
  const auto work = [&] {
    for (int i = 0; i < 100; ++i) {
      sending.send();
      solver.step(clock);
    }
  };
  while (ipc::Internals::summary(solver).knots < 100) work();
  const ConfinedEnd end =
      run_confined([&](Confined& process) { read_above(stream.name(), process); }, work);
  if (end.code == kForbidden) GTEST_SKIP() << "SCHED_FIFO needs CAP_SYS_NICE or RLIMIT_RTPRIO";
  EXPECT_EQ(end.signal, 0);
  EXPECT_EQ(end.code, 0);
  RecordProperty("samples", std::to_string(end.rounds));
  RecordProperty("preemptions", std::to_string(end.rounds / kBurst));
  RecordProperty("midway", std::to_string(end.midway));
  RecordProperty("overtaken", std::to_string(end.overtaken));
  RecordProperty("busy", std::to_string(end.busy));
  RecordProperty("unanswered", std::to_string(end.rounds - end.answered));
  RecordProperty("cpu_ns_per_sample",
                 std::to_string(end.cpu_ns / std::max<std::uint64_t>(1, end.rounds)));
  // No process stores while the reader samples, so that every sample succeeds at the first try.
  EXPECT_EQ(end.answered, end.rounds);
  EXPECT_GE(end.midway, kMidway);
  EXPECT_LT(end.cpu_ns, end.rounds * kMostCpuPerSample);
}

}  // namespace
}  // namespace splinecast::testing
