#include <fmt/format.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "apps/record/format/json.hpp"
#include "ipc/roles/internals.hpp"
#include "tests/apps/record/recorded.hpp"

/// The events of `record --on`: each begins a dump that has it.
namespace splinecast::testing {
namespace {

using std::chrono::milliseconds;

class RecordEvent : public RecorderTest {};

/// A clock whose reading number `look`, counted from 0, comes 80 ms later: a process that is
/// stopped at this place of a step.
class DelayedClock final : public Clock {
 public:
  explicit DelayedClock(int look) : look_(look) {}
  [[nodiscard]] Time now() const noexcept override {
    if (looks_++ == look_) usleep(80'000);
    return clock_.now();
  }

 private:
  MonotonicClock clock_;
  int look_;
  mutable int looks_ = 0;
};

/// A live stream of one dimension at 100 Hz, produced and solved in this process.
class SteadySource {
 public:
  explicit SteadySource(const std::string& name, SolverOptions options = {})
      : producer(name, {.dimensions = 1}), solver(name, options) {
    EXPECT_TRUE(solver.attach());
    next_ = clock_.now() + kLead;
  }

  static constexpr Time kLead = milliseconds(50);

  /// Appends the waypoints that are due, and solves them.
  void run() {
    for (; next_ <= clock_.now() + kLead; next_ += kInterval) append();
    step(clock_);
  }
  /// Appends one waypoint.
  void append() {
    const double x = std::sin(to_seconds(next_ - kInterval));
    (void)producer.append({.time = next_, .position = {&x, 1}});
  }
  void step(const Clock& clock) {
    while (solver.step(clock).consumed > 0) {
    }
  }

  Producer producer;
  Solver solver;

 private:
  static constexpr Time kInterval = milliseconds(10);
  MonotonicClock clock_;
  Time next_{};
};

/// Runs a source until a condition holds.
void run_until(SteadySource& source, const std::function<bool()>& condition) {
  EXPECT_TRUE(await([&] {
    source.run();
    return condition();
  }));
}

/// A recorder with `--on KIND`, and what it wrote.
struct EventRecorder {
  EventRecorder(std::string name, std::string event)
      : stream(std::move(name)),
        kind(std::move(event)),
        process(
            start_recorder({stream, "-o", folder.path("run.mcap"), "--last", "30", "--on", kind})) {
    process.await_message("'" + stream + "': recording");
  }
  [[nodiscard]] std::string dump() const {
    return folder.path(fmt::format("run.{}-0001.mcap", kind));
  }
  [[nodiscard]] bool has_dump() const {
    std::error_code error;
    return std::filesystem::file_size(dump(), error) > 1000 && !error;
  }
  /// Expects that the dump has the event, and that it verifies.
  void expect_dump(int code = 0) {
    process.signal(SIGINT);
    EXPECT_EQ(process.wait().code, 0);
    const auto events = messages_of(dump(), "/" + stream + "/events");
    EXPECT_TRUE(std::ranges::any_of(events, [&](const auto& e) { return e["event"] == kind; }));
    const auto schema = nlohmann::json::parse(apps::record::JsonMessages::event_schema());
    for (const auto& event : events) {
      for (const auto& [name, value] : event.items()) {
        EXPECT_TRUE(schema["properties"].contains(name)) << name;
      }
    }
    const Verified found = verify(dump());
    EXPECT_EQ(found.code, code) << found.err << found.json.dump(1);
    EXPECT_GT(found.stream(stream)["equal"], 0);
  }

  TestFolder folder;
  std::string stream;
  std::string kind;
  Process process;
};

/// Runs a source for a time and a number of waypoints, so that something has settled.
void settle(SteadySource& source) {
  constexpr ipc::Word kWaypoints = 60;
  const MonotonicClock clock;
  const Time end = clock.now() + milliseconds(400);
  run_until(source, [&] {
    return clock.now() >= end &&
           ipc::Internals::summary(source.solver).interpolated() >= kWaypoints;
  });
}

TEST_F(RecordEvent, AnUnderrunBeginsADump) {
  const TestStream stream;
  SteadySource source(stream.name());
  EventRecorder recorder(stream.name(), "underrun");
  settle(source);
  const MonotonicClock clock;
  EXPECT_TRUE(await([&] {  // no waypoint follows
    source.step(clock);
    return recorder.has_dump();
  }));
  recorder.expect_dump();
}

TEST_F(RecordEvent, ADeadlineMissBeginsADump) {
  const TestStream stream;
  SteadySource source(stream.name());
  EventRecorder recorder(stream.name(), "deadline");
  settle(source);
  // The solver is stopped before the commit of a revision, which is then too late. It reads the
  // clock to look for stoppers, when the step begins, and before and after the commit.
  run_until(source, [&] {
    source.append();
    source.step(DelayedClock(2));
    return recorder.has_dump();
  });
  recorder.expect_dump();
}

TEST_F(RecordEvent, ALateCommitBeginsADump) {
  const TestStream stream;
  SteadySource source(stream.name());
  EventRecorder recorder(stream.name(), "late");
  settle(source);
  // The solver is stopped between the reading of the clock and the commit.
  run_until(source, [&] {
    source.append();
    source.step(DelayedClock(3));
    return recorder.has_dump();
  });
  recorder.expect_dump(5);  // what the late commit changed cannot be compared
}

TEST_F(RecordEvent, ARefusalBeginsADump) {
  const TestStream stream;
  const double bound = 10;
  SteadySource source(stream.name(),
                      {.limits = MotionLimits{.upper = {bound}}, .beyond = Beyond::refuse});
  EventRecorder recorder(stream.name(), "refusal");
  settle(source);
  const MonotonicClock clock;
  const double beyond = 2 * bound;
  EXPECT_EQ(
      source.producer.append({.time = clock.now() + milliseconds(500), .position = {&beyond, 1}}),
      AppendStatus::accepted);
  EXPECT_TRUE(await([&] {
    source.step(clock);
    return recorder.has_dump();
  }));
  recorder.expect_dump();
}

TEST_F(RecordEvent, AnExcessOfALimitBeginsADump) {
  const TestStream stream;
  SteadySource source(stream.name(), {.limits = MotionLimits{.velocity = {0.1}}});
  EventRecorder recorder(stream.name(), "limit");
  run_until(source, [&] { return recorder.has_dump(); });
  recorder.process.signal(SIGINT);
  EXPECT_EQ(recorder.process.wait().code, 0);
  const auto events = messages_of(recorder.dump(), "/" + stream.name() + "/events");
  const auto found =
      std::ranges::find_if(events, [](const auto& event) { return event["event"] == "limit"; });
  ASSERT_NE(found, events.end());
  EXPECT_EQ((*found)["limit_kind"], "velocity");
}

TEST_F(RecordEvent, ATakeoverBeginsADump) {
  const TestStream stream;
  SteppedStream source(stream.name());
  EventRecorder recorder(stream.name(), "takeover");
  source.append_until(100);
  { const Solver ended = std::move(source.solver); }
  Process solver({"solve", stream.name(), "--quiet"});
  EXPECT_TRUE(await([&] { return recorder.has_dump(); }));
  recorder.expect_dump();
  solver.signal(SIGINT);
  (void)solver.wait();
}

/// How many excesses of a stream have settled, of those that were executed or replaced in time.
std::ptrdiff_t count_settled(const std::string& path, const std::string& stream, bool is_executed) {
  return std::ranges::count_if(messages_of(path, "/" + stream + "/events"), [&](const auto& event) {
    return event["event"] == "limit_settled" && event.contains("executed") &&
           event["executed"] == is_executed;
  });
}

TEST_F(RecordEvent, AnExcessOfTheSettledCurveIsExecuted) {
  const TestStream stream;
  const TestFolder folder;
  const std::string path = folder.path("run.mcap");
  SteppedStream source(stream.name(), {.limits = MotionLimits{.velocity = {1e-3}}});
  source.append_until(100);
  source.finish();
  EXPECT_EQ(run({"record", stream.name(), "-o", path, "--until-finished"}).code, 0);
  const auto exceeding = info(stream.name())["solver"]["exceeding"].get<std::ptrdiff_t>();
  ASSERT_GT(exceeding, 0);
  EXPECT_EQ(count_settled(path, stream.name(), true), exceeding);
}

TEST_F(RecordEvent, AnExcessThatWasReplacedInTimeIsNotExecuted) {
  const TestStream stream;
  SteadySource source(stream.name(), {.limits = MotionLimits{.velocity = {2}}});
  const TestFolder folder;
  const std::string path = folder.path("run.mcap");
  Process recorder = start_recorder({stream.name(), "-o", path});
  recorder.await_message("'" + stream.name() + "': recording");
  settle(source);
  // A far waypoint, which a stop replaces long before the curve is as fast as that.
  const MonotonicClock clock;
  const double far = 1e5;
  EXPECT_EQ(source.producer.append(
                {.time = clock.now() + std::chrono::minutes(10), .position = {&far, 1}}),
            AppendStatus::accepted);
  source.step(clock);
  EXPECT_EQ(source.producer.replace_from(clock.now() + milliseconds(100), {}),
            AppendStatus::accepted);
  source.step(clock);
  EXPECT_EQ(source.producer.finish(), AppendStatus::accepted);
  EXPECT_TRUE(await([&] {
    source.step(clock);
    return count_settled(path, stream.name(), false) > 0;
  }));
  recorder.signal(SIGINT);
  EXPECT_EQ(recorder.wait().code, 0);
  EXPECT_EQ(count_settled(path, stream.name(), true), 0);
}

/// What occurred before the recorder came is recorded, but begins no dump.
TEST_F(RecordEvent, AnEventOfBeforeBeginsNoDump) {
  const TestStream stream;
  SteppedStream source(stream.name(), {.limits = MotionLimits{.velocity = {1e-3}}});
  source.append_until(100);
  EventRecorder recorder(stream.name(), "limit");
  EXPECT_EQ(run({"record", "--trigger", std::to_string(recorder.process.pid())}).code, 0);
  const std::string trigger = recorder.folder.path("run.trigger-0001.mcap");
  ASSERT_TRUE(await_file(trigger, 1000));
  recorder.process.signal(SIGINT);
  EXPECT_EQ(recorder.process.wait().code, 0);
  EXPECT_FALSE(std::filesystem::exists(recorder.dump()));
  const auto events = messages_of(trigger, "/" + stream.name() + "/events");
  EXPECT_TRUE(std::ranges::any_of(events, [](const auto& e) { return e["event"] == "limit"; }));
}

/// The board keeps 128 excesses, and a stopped recorder cannot read the others.
TEST_F(RecordEvent, ExcessesThatWereOverwrittenAreCounted) {
  const TestStream stream;
  SteppedStream source(stream.name(), {.limits = MotionLimits{.velocity = {1e-3}}});
  EventRecorder recorder(stream.name(), "limit");
  recorder.process.signal(SIGSTOP);
  source.append_until(800, [](std::size_t i) {  // exceeds and keeps the limit in turn
    const double x = i % 8 < 4 ? 1.0 : 0.0;
    return std::vector<double>{x, x};
  });
  recorder.process.signal(SIGCONT);
  EXPECT_TRUE(await([&] { return recorder.has_dump(); }));
  recorder.expect_dump();
  const auto exceeding = info(stream.name())["solver"]["exceeding"].get<std::uint64_t>();
  ASSERT_GT(exceeding, 128U);
  std::uint64_t count = 0;
  for (const auto& event : messages_of(recorder.dump(), "/" + stream.name() + "/events")) {
    if (event["event"] == "limit") count += event.value("missed", std::uint64_t{1});
  }
  EXPECT_EQ(count, exceeding);
}

}  // namespace
}  // namespace splinecast::testing
