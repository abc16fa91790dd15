#include "splinecast/stopper.hpp"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include "ipc/layout/header.hpp"
#include "ipc/layout/request_control.hpp"
#include "ipc/mapping/region.hpp"
#include "ipc/memory/names.hpp"
#include "splinecast/clock.hpp"
#include "splinecast/errors.hpp"
#include "splinecast/producer.hpp"
#include "splinecast/reader.hpp"
#include "splinecast/solver.hpp"
#include "splinecast/streams.hpp"
#include "tests/fixtures/processes/process.hpp"

/// Stoppers of real streams in shared memory.
namespace splinecast {
namespace {

using namespace std::chrono_literals;
using testing::await;
using testing::Process;
using testing::run;
using testing::TestStream;

Time now() { return MonotonicClock().now(); }

/// A stream that this process produces: a slow sine, sent ahead by up to 300 ms.
class MovingStream {
 public:
  explicit MovingStream(const std::string& name)
      : producer_(name, {.dimensions = 1}), next_(now() + 200ms), begin_(next_) {}

  /// Sends the waypoints that are due. Returns the status of the last one.
  AppendStatus send() {
    AppendStatus status = AppendStatus::accepted;
    for (; next_ < now() + 300ms && status == AppendStatus::accepted; next_ += 10ms) {
      const double x = 1 - std::cos(to_seconds(next_ - begin_));
      status = producer_.append({.time = next_, .position = {&x, 1}});
    }
    return status;
  }
  AppendStatus send_until(const std::function<bool()>& is_done) {
    AppendStatus status = AppendStatus::accepted;
    EXPECT_TRUE(await([&] {
      status = send();
      return is_done();
    }));
    return status;
  }
  Producer& producer() { return producer_; }

 private:
  Producer producer_;
  Time next_;
  Time begin_;
};

/// A solver in a thread of this process.
class SolvingThread {
 public:
  explicit SolvingThread(std::string name)
      : thread_([this, name = std::move(name)] {
          Solver solver(name, {});
          while (!ends_) {
            (void)solver.attach();
            if (solver.step(MonotonicClock()).consumed == 0) solver.wait(50ms);
          }
        }) {}
  SolvingThread(const SolvingThread&) = delete;
  SolvingThread& operator=(const SolvingThread&) = delete;
  ~SolvingThread() {
    ends_ = true;
    thread_.join();
  }

 private:
  std::atomic<bool> ends_ = false;
  std::thread thread_;
};

/// The present velocity; 0 before the stream has begun.
double velocity(const std::string& name) {
  try {
    Reader reader(name);
    State state(reader.dimensions());
    return has_values(reader.sample(now(), state)) ? state.velocity()[0] : 0;
  } catch (const NoSuchStream&) {
    return 0;
  }
}

struct Stream : ::testing::Test {
  TestStream name;
  [[nodiscard]] bool rests() const { return velocity(name.name()) == 0; }
};

TEST_F(Stream, IsStoppedFromAnotherRoleAndMovesAgainAfterTheRelease) {
  MovingStream arm(name.name());
  const SolvingThread solver(name.name());
  arm.send_until([&] { return velocity(name.name()) > 0.2; });
  Stopper stopper(name.name(), "panel");
  EXPECT_FALSE(stopper.is_latched());
  const auto number = stopper.stop();
  EXPECT_TRUE(stopper.is_latched());
  EXPECT_TRUE(stopper.wait_in_force(number, 10s));
  EXPECT_EQ(arm.producer().stopped_by(), (std::vector<std::string>{"panel"}));
  EXPECT_TRUE(await([&] { return arm.send() == AppendStatus::stopped; }));
  EXPECT_TRUE(await([&] { return rests(); }));
  EXPECT_EQ(stopper.stop(), number);  // it is requested already
  EXPECT_TRUE(stopper.wait_in_force(stopper.release(), 10s));
  EXPECT_EQ(arm.send_until([&] { return !rests(); }), AppendStatus::accepted);
}

TEST_F(Stream, StaysStoppedWhenAllProcessesHaveEnded) {
  { (void)Stopper(name.name(), "panel").stop(); }
  {
    MovingStream arm(name.name());
    const SolvingThread solver(name.name());
    arm.send_until([&] { return arm.producer().stopped_by().size() == 1; });
    ASSERT_EQ(arm.producer().finish(), AppendStatus::accepted);
    EXPECT_TRUE(arm.producer().wait_until_consumed(10s));
  }
  MovingStream again(name.name());
  const SolvingThread solver(name.name());
  again.send_until([&] { return again.producer().stopped_by().size() == 1; });
  EXPECT_TRUE(await([&] { return again.send() == AppendStatus::stopped; }));
  Stopper stopper(name.name(), "panel");
  EXPECT_TRUE(stopper.is_latched());
  EXPECT_TRUE(stopper.wait_in_force(stopper.release(), 10s));
}

TEST_F(Stream, RefusesUnderTheNameOfTheStopper) {
  MovingStream arm(name.name());
  (void)arm.send();
  (void)Stopper(name.name(), "a-name-of-more-than-thirty-two-characters").stop();
  const SolvingThread solver(name.name());
  ASSERT_TRUE(arm.producer().wait_until_consumed(10s));
  const Refusals refused = arm.producer().refusals();
  ASSERT_FALSE(refused.items.empty());
  EXPECT_EQ(refused.items.front().reason, Refusal::stopped);
  EXPECT_EQ(refused.items.front().by, "a-name-of-more-than-thirty-two-c");
  EXPECT_NE(to_string(refused.items.front()).find("stopped by 'a-name"), std::string::npos);
}

/// A request that a process began to write, and did not end.
TEST_F(Stream, IsStoppedByATornRecord) {
  { (void)Stopper(name.name(), "panel").release(); }
  const std::string region = ipc::stopper_stream(name.name(), "panel");
  const auto header = ipc::peek_header(region, ipc::RegionKind::stopper, {});
  ASSERT_TRUE(header);
  std::fstream file(ipc::region_path(region, ipc::RegionKind::stopper),
                    std::ios::in | std::ios::out | std::ios::binary);
  file.seekp(static_cast<std::streamoff>(header->control));
  const std::uint64_t odd = 3;
  file.write(reinterpret_cast<const char*>(&odd), sizeof odd);  // NOLINT(*-reinterpret-cast)
  file.close();
  MovingStream arm(name.name());
  const SolvingThread solver(name.name());
  arm.send_until([&] { return !arm.producer().stopped_by().empty(); });
  Stopper stopper(name.name(), "panel");
  EXPECT_TRUE(stopper.is_latched());
  EXPECT_TRUE(stopper.wait_in_force(stopper.release(), 10s));
}

/// The file was deleted, as by someone who cleans up.
TEST_F(Stream, HearsAStopperWhoseRegionTakesThePlaceOfADeletedOne) {
  MovingStream arm(name.name());
  const SolvingThread solver(name.name());
  {
    Stopper first(name.name(), "panel");
    arm.send_until([&] { return true; });
    ASSERT_TRUE(first.wait_in_force(first.release(), 10s));
    ipc::unlink_region(ipc::stopper_stream(name.name(), "panel"), ipc::RegionKind::stopper);
    EXPECT_THROW((void)first.stop(), BadRegion);
  }
  Stopper second(name.name(), "panel");
  EXPECT_TRUE(second.wait_in_force(second.stop(), 10s));
}

TEST_F(Stream, CanHaveOneLivingStopperOfAName) {
  Stopper stopper(name.name(), "panel");
  EXPECT_THROW(Stopper(name.name(), "panel"), StreamBusy);
  EXPECT_THROW(Stopper(name.name(), "a/b"), BadRequest);
  EXPECT_THROW(Stopper("a!b", "panel"), BadRequest);
  const auto number = stopper.stop();
  EXPECT_FALSE(stopper.wait_in_force(number, 1ms));  // there is no stream
}

TEST_F(Stream, KeepsItsStopsWhenItIsRemoved) {
  { (void)Stopper(name.name(), "holds").stop(); }
  { (void)Stopper(name.name(), "released").release(); }
  { const Producer producer(name.name(), {.dimensions = 1}); }
  remove_stream(name.name());
  EXPECT_EQ(ipc::requester_names(name.name(), ipc::RegionKind::stopper),
            (std::vector<std::string>{"holds"}));
  EXPECT_TRUE(ipc::requester_names(name.name(), ipc::RegionKind::commander).empty());
}

TEST_F(Stream, IsNotTakenForALawBecauseOfItsStoppers) {
  (void)Stopper(name.name(), "panel").stop();
  Solver solver(name.name(), {});
  EXPECT_FALSE(solver.attach());
  EXPECT_FALSE(ipc::region_exists(name.name(), ipc::RegionKind::waypoints));
}

/// In one process that solves many streams, none of which is named.
TEST_F(Stream, IsStoppedByTheProgram) {
  Process solve({"solve", name.name() + "*"});
  MovingStream arm(name.name());
  ASSERT_TRUE(arm.producer().wait_for_solver(10s));
  arm.send_until([&] { return velocity(name.name()) > 0.2; });
  const auto stopped = run({"stop", name.name(), "--as", "anna"});
  EXPECT_EQ(stopped.code, 0) << stopped.err;
  EXPECT_NE(stopped.out.find("the stop of 'anna' is in force"), std::string::npos) << stopped.out;
  EXPECT_TRUE(await([&] { return arm.send() == AppendStatus::stopped; }));
  EXPECT_EQ(testing::info(name.name())["solver"]["stoppers"][0]["name"], "anna");
  solve.await_message("stopper 'anna' holds the stream");
  const auto list = run({"ls"});
  EXPECT_NE(list.out.find("stopped by 'anna'"), std::string::npos) << list.out;
  const auto second = run({"stop", name.name(), "--as", "panel", "--json"});
  EXPECT_EQ(second.code, 0) << second.err;
  const auto json = nlohmann::json::parse(second.out);
  EXPECT_EQ(json[0]["holders"], (nlohmann::json{"anna", "panel"}));
  EXPECT_EQ(json[0]["in_force"], true);
  const auto released = run({"stop", name.name() + "*", "--release", "--as", "anna"});
  EXPECT_EQ(released.code, 0) << released.err;
  EXPECT_NE(released.out.find("still held by 'panel'"), std::string::npos) << released.out;
  EXPECT_EQ(run({"stop", name.name(), "--release", "--as", "panel"}).code, 0);
  EXPECT_EQ(arm.send_until([&] { return !rests(); }), AppendStatus::accepted);
}

TEST_F(Stream, IsStoppedWhenItComesIfThereIsNoneYet) {
  const auto early = run({"stop", name.name(), "--as", "anna", "--wait", "0.05"});
  EXPECT_EQ(early.code, 4);
  EXPECT_NE(early.err.find("no stream of this name; the request remains"), std::string::npos)
      << early.err;
  EXPECT_NE(run({"ls"}).out.find(name.name()), std::string::npos);
  MovingStream arm(name.name());
  const SolvingThread solver(name.name());
  arm.send_until([&] { return !arm.producer().stopped_by().empty(); });
}

TEST_F(Stream, ThatIsGoneIsReleasedAllTheSame) {
  (void)run({"stop", name.name(), "--as", "anna", "--wait", "0"});
  const auto released = run({"stop", name.name(), "--as", "anna", "--release"});
  EXPECT_EQ(released.code, 0) << released.err;
  EXPECT_NE(released.out.find("no stream of this name"), std::string::npos) << released.out;
}

TEST_F(Stream, WithoutASolverIsReportedInTime) {
  const Producer producer(name.name(), {.dimensions = 1});
  const auto stopped = run({"stop", name.name(), "--as", "anna", "--wait", "0.05"});
  EXPECT_EQ(stopped.code, 4);
  EXPECT_NE(stopped.err.find("is not in force after 0.05 s: no solver has heard it"),
            std::string::npos)
      << stopped.err;
}

TEST_F(Stream, ThatIsRecordedHasNoStoppers) {
  const Producer producer(name.name(), {.dimensions = 1, .clock = StreamClock::recorded});
  const auto stopped = run({"stop", name.name()});
  EXPECT_EQ(stopped.code, 2);
  EXPECT_NE(stopped.err.find("is a recorded stream"), std::string::npos) << stopped.err;
  EXPECT_EQ(run({"stop", name.name() + "*"}).code, 4);
}

TEST_F(Stream, IsStoppedWhileALivingProcessHasTheStoppersName) {
  MovingStream arm(name.name());
  const SolvingThread solver(name.name());
  arm.send_until([&] { return velocity(name.name()) > 0.1; });
  Stopper panel(name.name(), "anna");
  const auto stopped = run({"stop", name.name(), "--as", "anna"});
  EXPECT_EQ(stopped.code, 0) << stopped.err;
  EXPECT_NE(stopped.err.find("requested as 'anna."), std::string::npos) << stopped.err;
  const auto released = run({"stop", name.name(), "--as", "anna", "--release"});
  EXPECT_EQ(released.code, 4);
  EXPECT_EQ(arm.producer().stopped_by().size(), 1U);
}

TEST_F(Stream, ThatIsFinishedCannotBeStoppedInItsLastMotion) {
  Producer producer(name.name(), {.dimensions = 1});
  const SolvingThread solver(name.name());
  ASSERT_TRUE(producer.wait_for_solver(10s));
  const Time begin = now() + 200ms;
  for (int i = 0; i <= 400; ++i) {
    const double x = 1 - std::cos(0.1 * i);
    ASSERT_EQ(producer.append({.time = begin + i * 10ms, .position = {&x, 1}}),
              AppendStatus::accepted);
  }
  ASSERT_EQ(producer.finish(), AppendStatus::accepted);
  ASSERT_TRUE(producer.wait_until_consumed(10s));
  const auto stopped = run({"stop", name.name(), "--as", "anna"});
  EXPECT_EQ(stopped.code, 4);
  EXPECT_NE(stopped.err.find("came after its finish"), std::string::npos) << stopped.err;
}

TEST(APatternOfStreams, ThatMatchesNoneIsReported) {
  const auto stopped = run({"stop", testing::own_prefix() + "none*"});
  EXPECT_EQ(stopped.code, 4);
  EXPECT_NE(stopped.err.find("no stream matches"), std::string::npos) << stopped.err;
}

}  // namespace
}  // namespace splinecast
