#include "ipc/sweep/many_streams.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "ipc/mapping/owner_lock.hpp"
#include "ipc/mapping/region.hpp"
#include "splinecast/errors.hpp"
#include "splinecast/reader.hpp"
#include "tests/ipc/sweep/recording_sweep.hpp"

/// One thread solves many streams over real shared memory, in one process.
namespace splinecast::ipc {
namespace {

using testing::append_at;
using testing::await;
using testing::make_producer;
using testing::News;
using testing::RecordingSweep;
using testing::TestStream;

/// A clock that the test sets. Counts its readings.
class SetClock final : public Clock {
 public:
  [[nodiscard]] Time now() const noexcept override {
    ++reads;
    return time;
  }
  Time time = MonotonicClock().now();
  mutable int reads = 0;
};

TEST(StreamSweep, APatternFindsNewStreamsAndForgetsRemovedOnes) {
  const TestStream family;
  const std::string stream = family.name() + ".x";
  const TestStream other;
  RecordingSweep reported({family.name() + ".*"});
  reported.sweep.sweep(reported.clock);
  EXPECT_TRUE(reported.news.empty());
  Producer unwanted = make_producer(other.name());
  {
    Producer producer = make_producer(stream);
    append_at(producer, Time(0));
    EXPECT_TRUE(reported.await_news(SweepNews::solving, stream));
    EXPECT_TRUE(await([&] {
      reported.sweep.sweep(reported.clock);
      return producer.wait_until_consumed(Time(0));
    }));
    EXPECT_EQ(reported.sweep.solved(), 1U);
    producer.withdraw();
  }
  EXPECT_TRUE(reported.await_news(SweepNews::gone, stream));
  EXPECT_EQ(reported.sweep.solved(), 0U);
  EXPECT_FALSE(is_owned(stream, RegionKind::spline));
  EXPECT_EQ(reported.count(SweepNews::solving, other.name()), 0);
  Producer again = make_producer(stream);
  reported.news.clear();
  EXPECT_TRUE(reported.await_news(SweepNews::solving, stream));
  again.withdraw();
  EXPECT_TRUE(reported.await_news(SweepNews::gone, stream));
  unlink_region(stream, RegionKind::spline);
  OwnerLock(stream, RegionKind::spline).remove_file();
}

TEST(StreamSweep, ANamedStreamIsOwnedBeforeItsProducerStarts) {
  const TestStream stream;
  RecordingSweep reported({stream.name()});
  EXPECT_EQ(reported.count(SweepNews::waiting, stream.name()), 1);
  EXPECT_TRUE(is_owned(stream.name(), RegionKind::spline));
  EXPECT_THROW(Solver(stream.name(), {}), StreamBusy);
  Producer producer = make_producer(stream.name());
  EXPECT_TRUE(reported.await_news(SweepNews::solving, stream.name()));
  EXPECT_TRUE(producer.wait_for_solver(Time(1)));
}

TEST(StreamSweep, AStreamOfAnotherSolverIsTakenOverOnlyWhenThatSolverDies) {
  const TestStream stream;
  Producer producer = make_producer(stream.name());
  std::optional<Solver> other(std::in_place, stream.name(), RecordingSweep::small());
  ASSERT_TRUE(other->attach());
  const MonotonicClock clock;
  append_at(producer, Time(0));
  EXPECT_EQ(other->step(clock).consumed, 1U);
  RecordingSweep reported({stream.name()});
  for (int i = 0; i < 3; ++i) reported.sweep.sweep(clock);
  EXPECT_EQ(reported.news, (News{{SweepNews::elsewhere, stream.name()}}));
  other.reset();
  EXPECT_TRUE(reported.await_news(SweepNews::solving, stream.name()));
  append_at(producer, Time(10'000'000));
  EXPECT_TRUE(await([&] {
    reported.sweep.sweep(clock);
    return producer.consumed() == 2;
  }));
  EXPECT_EQ(reported.count(SweepNews::elsewhere, stream.name()), 1);
}

TEST(StreamSweep, AnIdleStreamCostsNoStep) {
  const TestStream stream;
  Producer producer = make_producer(stream.name());
  RecordingSweep reported({stream.name()});
  ASSERT_TRUE(reported.await_news(SweepNews::solving, stream.name()));
  SetClock clock;
  reported.sweep.sweep(clock);
  clock.reads = 0;
  for (int i = 0; i < 10; ++i) EXPECT_FALSE(reported.sweep.sweep(clock));
  EXPECT_EQ(clock.reads, 10);  // one per sweep; a step that publishes adds two more
  append_at(producer, Time(0));
  EXPECT_FALSE(reported.sweep.sweep(clock));
  EXPECT_EQ(clock.reads, 13);
  EXPECT_EQ(producer.consumed(), 1U);
}

TEST(StreamSweep, AnIdleStreamIsPolledOnlyInSomeSweeps) {
  const TestStream quiet;
  const TestStream busy;
  Producer first = make_producer(quiet.name());
  Producer second = make_producer(busy.name());
  RecordingSweep reported({quiet.name(), busy.name()});
  ASSERT_TRUE(reported.await_news(SweepNews::solving, quiet.name()));
  ASSERT_TRUE(reported.await_news(SweepNews::solving, busy.name()));
  SetClock clock;
  int sent = 0;
  const auto sweeps_to_take = [&](Producer& producer) {
    append_at(producer, std::chrono::milliseconds(++sent));
    int sweeps = 0;
    while (!producer.wait_until_consumed(Time(0))) {
      reported.sweep.sweep(clock);
      ++sweeps;
    }
    return sweeps;
  };
  EXPECT_EQ(sweeps_to_take(first), 1);
  constexpr Time kPause = std::chrono::milliseconds(1);
  EXPECT_EQ(reported.sweep.next_pause(), kPause);

  int most_sweeps = 0;
  for (int round = 0; round < 2; ++round) {
    clock.time += PollSchedule::kIdleAfter;
    reported.sweep.sweep(clock);
    EXPECT_EQ(reported.sweep.next_pause(), PollSchedule::kIdlePause);
    EXPECT_EQ(sweeps_to_take(second), 1);  // after the long pause the sweep polls all streams
    EXPECT_EQ(reported.sweep.next_pause(), kPause);
    EXPECT_EQ(sweeps_to_take(second), 1);
    // An idle stream is polled only in some sweeps. Once it has a waypoint, it is busy and is
    // polled in every sweep.
    most_sweeps = std::max(most_sweeps, sweeps_to_take(first));
    EXPECT_EQ(sweeps_to_take(first), 1);
  }
  EXPECT_GT(most_sweeps, 1);
  EXPECT_LE(most_sweeps, PollSchedule::kIdlePause / kPause);
}

TEST(StreamSweep, IdleStreamsKeepALongPauseAndASweepWithoutStreamsAShortOne) {
  const TestStream stream;
  Producer producer = make_producer(stream.name());
  StreamSweep sweep(
      {stream.name()}, RecordingSweep::small(), [](auto&&...) {}, std::chrono::milliseconds(30));
  SetClock clock;
  EXPECT_TRUE(await([&] {
    sweep.sweep(clock);
    return sweep.solved() == 1;
  }));
  clock.time += PollSchedule::kIdleAfter;
  sweep.sweep(clock);
  EXPECT_EQ(sweep.next_pause(), std::chrono::milliseconds(30));
  append_at(producer, Time(0));
  sweep.sweep(clock);
  EXPECT_EQ(producer.consumed(), 1U);

  RecordingSweep none({"no_" + stream.name() + ".*"});
  none.sweep.sweep(clock);
  EXPECT_EQ(none.sweep.next_pause(), std::chrono::milliseconds(1));
}

TEST(StreamSweep, ALiveStreamSettlesWithoutWaypointsUntilItRests) {
  const TestStream stream;
  SetClock clock;
  Producer producer = make_producer(stream.name(), StreamClock::monotonic);
  RecordingSweep reported({stream.name()});
  ASSERT_TRUE(reported.await_news(SweepNews::solving, stream.name()));
  ASSERT_TRUE(producer.wait_for_solver(Time(1)));
  append_at(producer, clock.time + std::chrono::milliseconds(50));
  append_at(producer, clock.time + std::chrono::milliseconds(60));
  reported.sweep.sweep(clock);
  const Reader reader(stream.name());
  const auto settled_until = [&] { return reader.progress().value().settled_until; };
  Time settled = settled_until();
  const Time end = clock.time + std::chrono::seconds(1);
  int revisions = 0;
  for (; clock.time < end; clock.time += std::chrono::milliseconds(1)) {
    reported.sweep.sweep(clock);
    if (settled_until() == settled) continue;
    EXPECT_LE(settled_until() - settled, std::chrono::milliseconds(3));
    settled = settled_until();
    ++revisions;
  }
  // The settled time is raised every half freeze-ahead, which is every 3 ms with steps of 1 ms, for
  // 60 ms of curve and 250 ms of stop segment.
  EXPECT_GE(revisions, 100);
  EXPECT_LE(revisions, 105);
}

TEST(StreamSweep, AStreamWithMoreThanOneBatchIsSweptAgainWithoutAPause) {
  const TestStream stream;
  Producer producer(stream.name(),
                    {.dimensions = 1, .clock = StreamClock::recorded, .capacity = 512});
  for (int i = 0; i < 300; ++i) append_at(producer, Time(1'000'000) * i);
  RecordingSweep reported({stream.name()});
  ASSERT_TRUE(reported.await_news(SweepNews::solving, stream.name()));
  while (reported.sweep.sweep(reported.clock)) {
  }
  EXPECT_TRUE(producer.wait_until_consumed(Time(0)));
}

TEST(StreamSweep, AFinishIsReportedOnceAndANewStreamOfThatNameIsSolved) {
  const TestStream stream;
  RecordingSweep reported({stream.name()});
  {
    Producer producer = make_producer(stream.name());
    append_at(producer, Time(0));
    ASSERT_EQ(producer.finish({}), AppendStatus::accepted);
    EXPECT_TRUE(reported.await_news(SweepNews::finished, stream.name()));
  }
  Producer again = make_producer(stream.name());
  append_at(again, Time(0));
  EXPECT_TRUE(await([&] {
    reported.sweep.sweep(reported.clock);
    return again.wait_until_consumed(Time(0));
  }));
  EXPECT_EQ(reported.count(SweepNews::solving, stream.name()), 2);
  EXPECT_EQ(reported.count(SweepNews::finished, stream.name()), 1);
}

TEST(StreamSweep, AnUnsolvableStreamIsGivenUpOnceAndTheOthersContinue) {
  const TestStream bad;
  const TestStream good;
  Producer of_bad = make_producer(bad.name());
  Producer of_good = make_producer(good.name());
  {
    Solver before(bad.name(), {.settle = 3, .capacity = 64});
    ASSERT_TRUE(before.attach());
  }
  RecordingSweep reported({bad.name(), good.name()}, {.settle = 4, .capacity = 64});
  EXPECT_TRUE(reported.await_news(SweepNews::given_up, bad.name()));
  EXPECT_NE(reported.why.find("settle lag 3, not 4"), std::string::npos) << reported.why;
  EXPECT_TRUE(reported.await_news(SweepNews::solving, good.name()));
  Producer passing = make_producer(good.name() + ".passing");  // changes the folder
  reported.sweep.sweep(reported.clock);
  passing.withdraw();
  EXPECT_EQ(reported.count(SweepNews::given_up, bad.name()), 1);
  EXPECT_FALSE(is_owned(bad.name(), RegionKind::spline));
}

TEST(StreamSweep, InvalidOptionsAreRefusedImmediately) {
  EXPECT_THROW(RecordingSweep({"unused.*"}, {.capacity = 1}), BadRequest);
  EXPECT_THROW(RecordingSweep({"no/name"}), BadRequest);
}

TEST(StreamSweep, StreamsBeyondTheDescriptorLimitWaitUntilOthersEnd) {
  const TestStream family;
  std::vector<std::string> names;
  std::vector<Producer> producers;
  for (const char* const suffix : {".0", ".1", ".2"}) {
    names.push_back(family.name() + suffix);
    producers.push_back(make_producer(names.back()));
  }
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_NOFILE, &before), 0);
  const rlimit tight{.rlim_cur = 32 + 2 * StreamSweep::kDescriptorsPerStream,
                     .rlim_max = before.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &tight), 0);
  {
    RecordingSweep reported({family.name() + ".*"});
    EXPECT_TRUE(reported.await_news(SweepNews::no_descriptors, names[2]));
    EXPECT_EQ(reported.sweep.solved(), 2U);
    producers[0].withdraw();
    EXPECT_TRUE(reported.await_news(SweepNews::solving, names[2]));
    EXPECT_EQ(reported.count(SweepNews::no_descriptors, names[2]), 1);
  }
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &before), 0);
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (i > 0) producers[i].withdraw();
    unlink_region(names[i], RegionKind::spline);
    OwnerLock(names[i], RegionKind::spline).remove_file();
  }
}

TEST(Names, MatchShellPatterns) {
  EXPECT_TRUE(is_pattern("arm.*"));
  EXPECT_TRUE(is_pattern("arm.[12]"));
  EXPECT_FALSE(is_pattern("arm.1"));
  EXPECT_TRUE(matches("arm.*", "arm.left.1"));
  EXPECT_TRUE(matches("arm.[12]", "arm.2"));
  EXPECT_FALSE(matches("arm.[12]", "arm.3"));
  EXPECT_FALSE(matches("arm.?", "arm.10"));
}

TEST(FolderWatch, ReportsCreatedAndRemovedFilesOnce) {
  FolderWatch watch;
  EXPECT_TRUE(watch.has_changed());
  const TestStream stream;
  // Other processes may also create and remove files, but not continuously.
  EXPECT_TRUE(await([&] { return !watch.has_changed(); }));
  Producer producer = make_producer(stream.name());
  EXPECT_TRUE(watch.has_changed());
  EXPECT_TRUE(await([&] { return !watch.has_changed(); }));
  producer.withdraw();
  EXPECT_TRUE(watch.has_changed());
}

}  // namespace
}  // namespace splinecast::ipc
