#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "ipc/board/reader.hpp"
#include "ipc/layout/check.hpp"
#include "ipc/layout/header.hpp"
#include "ipc/mapping/region.hpp"
#include "ipc/memory/names.hpp"
#include "ipc/options/stream.hpp"
#include "ipc/roles/internals.hpp"
#include "splinecast/clock.hpp"
#include "splinecast/errors.hpp"
#include "splinecast/producer.hpp"
#include "splinecast/reader.hpp"
#include "splinecast/solver.hpp"
#include "splinecast/streams.hpp"
#include "tests/fixtures/curves/mesh.hpp"
#include "tests/fixtures/processes/process.hpp"
#include "tests/fixtures/streams/memory_stream.hpp"

/// The three roles over real shared memory, in one process.
namespace splinecast::ipc {
namespace {

using testing::TestStream;

constexpr Time kSecond{1'000'000'000};

ProducerOptions recorded(std::size_t dimensions) {
  return {.dimensions = dimensions, .clock = StreamClock::recorded, .start = {}};
}

TEST(Roles, AWaypointTravelsFromProducerToReader) {
  const TestStream stream;
  Producer producer(stream.name(), recorded(2));
  Solver solver(stream.name(), {});
  const MonotonicClock clock;
  EXPECT_FALSE(solver.attached());
  ASSERT_TRUE(solver.attach());
  EXPECT_TRUE(producer.wait_for_solver(kSecond));
  Reader reader(stream.name());
  State state(2);
  EXPECT_EQ(reader.sample(Time(0), state), SampleStatus::no_data);
  const std::vector<double> x{1, -2};
  ASSERT_EQ(producer.append({Time(0), x, {}, {}}), AppendStatus::accepted);
  EXPECT_EQ(solver.step(clock).consumed, 1U);
  EXPECT_EQ(reader.wait(kSecond), WaitStatus::advanced);
  EXPECT_EQ(reader.sample(Time(0), state), SampleStatus::stopping);
  EXPECT_EQ(reader.wait(Time::min()), WaitStatus::timed_out);  // as 0: nothing is new
  EXPECT_EQ(state.position()[1], -2);
  EXPECT_EQ(producer.consumed(), 1U);
  ASSERT_EQ(producer.finish({}), AppendStatus::accepted);
  solver.step(clock);
  EXPECT_EQ(reader.sample(Time(0), state), SampleStatus::settled);
  EXPECT_EQ(reader.dimensions(), 2U);
  EXPECT_EQ(reader.clock(), StreamClock::recorded);
}

TEST(Roles, AProducerContinuesAfterAPauseLongerThanTheLargestInterval) {
  const TestStream stream;
  constexpr Time kMost{30'000'000};
  Producer producer(stream.name(), {.dimensions = 1, .limits = {.max_interval = kMost}});
  const MonotonicClock clock;
  const std::vector<double> x{1};
  const Time first = clock.now() + std::chrono::milliseconds(5);
  ASSERT_EQ(producer.append({first, x, {}, {}}), AppendStatus::accepted);
  EXPECT_EQ(producer.append({first + 1000 * kMost, x, {}, {}}), AppendStatus::too_far_apart);
  while (clock.now() <= first + 2 * kMost) std::this_thread::yield();
  EXPECT_EQ(producer.append({first + 2 * kMost, x, {}, {}}), AppendStatus::accepted);
}

TEST(Roles, AReaderSeesTheNamesUnitsAndSettleLagOfTheStream) {
  const TestStream stream;
  auto options = recorded(2);
  options.names = {"shoulder", "elbow"};
  options.units = {"rad", "rad"};
  Producer producer(stream.name(), options);
  Solver solver(stream.name(), {.settle = 3, .tail = Tail::clamped});
  ASSERT_TRUE(solver.attach());
  const Reader reader(stream.name());
  EXPECT_EQ(reader.names(), options.names);
  EXPECT_EQ(dimension_units(Internals::header(reader)), options.units);
  EXPECT_EQ(Internals::header(reader).settle, 3U);
}

TEST(Roles, ASleepingSolverIsWokenByAnAppend) {
  const TestStream stream;
  Producer producer(stream.name(), recorded(1));
  Solver solver(stream.name(), {});
  ASSERT_TRUE(solver.attach());
  ASSERT_TRUE(producer.wait_for_solver(kSecond));
  const std::vector<double> x{0};
  std::thread appending([&] {
    // Appends as soon as the solver reports that it sleeps.
    const Region region = Region::open(stream.name(), RegionKind::spline, false);
    const RegionHeader header = copy_header(region.bytes());
    const KnotBoardReader board(region.bytes(),
                                checked_board_layout(header, region.bytes().size()));
    while (!board.sleeping()) std::this_thread::yield();
    EXPECT_EQ(producer.append({Time(0), x, {}, {}}), AppendStatus::accepted);
  });
  const MonotonicClock clock;
  while (solver.step(clock).consumed == 0) solver.wait(60 * kSecond);
  appending.join();
  EXPECT_EQ(Internals::summary(solver).knots, 1U);
}

TEST(Roles, AReaderThatWaitsIsWokenByARevision) {
  const TestStream stream;
  Producer producer(stream.name(), recorded(1));
  Solver solver(stream.name(), {});
  ASSERT_TRUE(solver.attach());
  std::atomic<bool> waiting{false};
  WaitStatus status{};
  std::thread reading([&] {
    Reader reader(stream.name());
    waiting = true;
    status = reader.wait(60 * kSecond);
  });
  while (!waiting) std::this_thread::yield();
  const std::vector<double> x{0};
  ASSERT_EQ(producer.append({Time(0), x, {}, {}}), AppendStatus::accepted);
  solver.step(MonotonicClock());
  reading.join();
  EXPECT_EQ(status, WaitStatus::advanced);
}

TEST(Roles, WaitsEndAtTheirTimeout) {
  const TestStream stream;
  EXPECT_THROW(Reader(stream.name(), Time(1)), NoSuchStream);
  auto options = recorded(1);
  options.capacity = 2;
  Producer producer(stream.name(), options);
  EXPECT_FALSE(producer.wait_for_solver(Time(1)));
  const std::vector<double> x{0};
  ASSERT_EQ(producer.append({Time(0), x, {}, {}}), AppendStatus::accepted);
  ASSERT_EQ(producer.append({Time(2000), x, {}, {}}), AppendStatus::accepted);
  EXPECT_EQ(producer.append({Time(4000), x, {}, {}}), AppendStatus::full);
  EXPECT_FALSE(producer.wait_for_room(Time(1)));
  EXPECT_FALSE(producer.wait_until_consumed(Time(1)));
  EXPECT_FALSE(producer.solver_alive());
}

TEST(Roles, SuccessiveSolversShareOneBoard) {
  const TestStream stream;
  const auto mesh = testing::random_mesh(1, 40, 1, 3);
  Producer producer(stream.name(), recorded(1));
  const MonotonicClock clock;
  std::optional<Reader> reader;
  State state(1);
  for (std::size_t i = 0; i < mesh.size(); ++i) {
    Solver solver(stream.name(), {});
    ASSERT_TRUE(solver.attach());
    EXPECT_EQ(solver.took_over(), i > 0);
    ASSERT_EQ(producer.append({mesh.times[i], mesh.position(i), {}, {}}), AppendStatus::accepted);
    solver.step(clock);
    if (!reader) reader.emplace(stream.name());
    EXPECT_EQ(reader->sample(mesh.times[i], state), SampleStatus::stopping);
    EXPECT_EQ(state.position()[0], mesh.position(i)[0]);
  }
  EXPECT_EQ(Internals::header(*reader).epoch, 1U);
}

TEST(Roles, AForkedChildThatDestroysItsSolverDoesNotReleaseTheLock) {
  const TestStream stream;
  std::optional<Solver> solver;
  solver.emplace(stream.name(), SolverOptions{});
  const pid_t child = fork();
  if (child == 0) {
    solver.reset();
    _exit(0);
  }
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_EQ(status, 0);
  EXPECT_THROW(Solver(stream.name(), {}), StreamBusy);
}

TEST(Roles, ARefusedRemovalLeavesNoLockFile) {
  const TestStream stream;
  const Solver solver(stream.name(), {});
  EXPECT_THROW(remove_stream(stream.name()), StreamBusy);
  EXPECT_FALSE(std::filesystem::exists(lock_path(stream.name(), RegionKind::waypoints)));
}

TEST(Roles, VeryLongWaitsDoNotTimeOutImmediately) {
  const TestStream stream;
  testing::FixedClock clock;
  clock.time = Time(5);
  EXPECT_EQ(deadline(clock, Time::max()), Time::max());
  EXPECT_EQ(deadline(clock, Time(7)), Time(12));
}

TEST(Roles, BadOptionsAreRefusedBeforeARegionIsCreated) {
  const TestStream stream;
  EXPECT_THROW(Producer(stream.name(), recorded(0)), BadRequest);
  EXPECT_THROW(Producer(stream.name(), recorded(65)), BadRequest);
  auto bad = recorded(1);
  bad.capacity = 1;
  EXPECT_THROW(Producer(stream.name(), bad), BadRequest);
  bad = recorded(2);
  bad.names = {"one"};
  EXPECT_THROW(Producer(stream.name(), bad), BadRequest);
  bad = recorded(1);
  bad.limits = {.min_interval = Time(10), .max_interval = Time(5)};
  EXPECT_THROW(Producer(stream.name(), bad), BadRequest);
  EXPECT_THROW(Solver(stream.name(), {.settle = 65}), BadRequest);
  EXPECT_THROW(Solver(stream.name(), {.stop_time = Time(0)}), BadRequest);
  EXPECT_THROW(Solver(stream.name(), {.capacity = 10}), BadRequest);
  EXPECT_FALSE(region_exists(stream.name(), RegionKind::waypoints));
  EXPECT_FALSE(region_exists(stream.name(), RegionKind::spline));
}

/// A producer that found none would not know where the machine is, and start anywhere.
TEST(ABoard, IsThereAtAnyTimeWhileItsStreamIsCreatedAgain) {
  const TestStream stream;
  Solver solver(stream.name(), {});
  std::atomic<int> missing = -1;
  std::atomic<bool> is_over = false;
  std::thread watch([&] {
    while (!is_over) {
      const bool exists = ipc::region_exists(stream.name(), ipc::RegionKind::spline);
      if (exists && missing < 0) missing = 0;
      if (!exists && missing >= 0) ++missing;
    }
  });
  for (int i = 0; i < 100; ++i) {
    Producer producer(stream.name(), {.dimensions = 1});
    ASSERT_EQ(producer.finish(), AppendStatus::accepted);
    EXPECT_TRUE(testing::await([&] {
      if (solver.attach()) (void)solver.step(MonotonicClock());
      return producer.wait_until_consumed(Time(0));
    }));
  }
  is_over = true;
  watch.join();
  EXPECT_EQ(missing, 0);
}

/// What a solver leaves that is killed while it gives its board the name of the earlier one: the
/// readers of that one leave it, and the next solver makes the board.
TEST(ABoard, IsLeftByItsReadersBeforeAnotherTakesItsName) {
  const TestStream stream;
  const MonotonicClock clock;
  {
    Producer earlier(stream.name(), {.dimensions = 1});
    ASSERT_EQ(earlier.finish(), AppendStatus::accepted);
  }
  Solver solver(stream.name(), {});
  ASSERT_TRUE(solver.attach());
  (void)solver.step(clock);
  Reader reader(stream.name());
  const Producer later(stream.name(), {.dimensions = 1});

  const std::string obstacle =
      ipc::region_path(stream.name(), ipc::RegionKind::spline) + ".new/obstacle";
  std::filesystem::create_directories(obstacle);
  (void)solver.step(clock);
  EXPECT_THROW((void)solver.attach(), BadRegion);
  State state(1);
  EXPECT_EQ(reader.sample(clock.now(), state), SampleStatus::retired);
  EXPECT_THROW(Reader(stream.name()), NoSuchStream);

  std::filesystem::remove_all(std::filesystem::path(obstacle).parent_path());
  ASSERT_TRUE(solver.attach());
  EXPECT_EQ(Reader(stream.name()).sample(clock.now(), state), SampleStatus::no_data);
}

}  // namespace
}  // namespace splinecast::ipc
