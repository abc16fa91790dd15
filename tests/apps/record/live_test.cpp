#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "apps/messages/json_fields.hpp"
#include "ipc/layout/summary.hpp"
#include "ipc/roles/internals.hpp"
#include "splinecast/stopper.hpp"
#include "tests/apps/record/live_reader.hpp"
#include "tests/apps/record/recorded.hpp"
#include "tests/fixtures/messages/rows_of.hpp"

/// `record` beside live streams of this process.
namespace splinecast::testing {
namespace {

using std::chrono::milliseconds;

constexpr Time kInterval = milliseconds(10);

/// CLOCK_MONOTONIC in a process that is stopped for some time directly after one of its readings.
class StoppedClock final : public Clock {
 public:
  [[nodiscard]] Time now() const noexcept override {
    const Time seen = clock_.now();
    // Simulates what the kernel does to a process: it waits for nothing.
    if (readings_left_ > 0 && --readings_left_ == 0) std::this_thread::sleep_for(pause_);
    return seen;
  }
  /// Stops after reading number `reading` from now on, counted from 1.
  void stop_after(int reading, Time pause) {
    readings_left_ = reading;
    pause_ = pause;
  }

 private:
  MonotonicClock clock_;
  Time pause_{};
  mutable int readings_left_ = 0;
};

/// A live stream of one dimension, produced and solved in this process, at 100 Hz.
class LiveSource {
 public:
  explicit LiveSource(std::string name)
      : name_(std::move(name)), producer_(name_, {.dimensions = 1, .names = {"x"}}) {
    attach();
    begin_at(clock.now() + milliseconds(100));
  }

  /// Ends the solver; the next one takes over the stream.
  void take_over() {
    solver_.reset();
    attach();
  }

  /// The next waypoints begin at t.
  void begin_at(Time t) { next_ = t; }

  /// Solves the stream for `duration`, and appends each waypoint `lead` before its time.
  void run(Time duration, Time lead) {
    for (const Time end = clock.now() + duration; clock.now() < end;) {
      while (next_ <= clock.now() + lead) append();
      step();
      solver_->wait(std::min(next_ - lead, end) - clock.now());
    }
  }
  /// Solves it without new waypoints.
  void starve(Time duration) {
    for (const Time end = clock.now() + duration; clock.now() < end;) {
      step();
      solver_->wait(end - clock.now());
    }
  }

  /// Replaces everything from `ahead` after now by `count` waypoints of another motion; 0: a stop.
  void replace(Time ahead, std::size_t count) {
    const Time from = clock.now() + ahead;
    shift_ += 0.5;
    std::vector<double> positions(count);
    std::vector<Waypoint> waypoints;
    for (std::size_t i = 0; i < count; ++i) {
      const Time t = from + milliseconds(100) + kInterval * static_cast<std::int64_t>(i);
      positions[i] = position(t);
      waypoints.push_back({.time = t, .position = std::span(positions).subspan(i, 1)});
    }
    ASSERT_EQ(producer_.replace_from(from, waypoints), AppendStatus::accepted);
    std::erase_if(rows_, [from](const CopiedRow& row) { return row.time >= from; });
    for (std::size_t i = 0; i < count; ++i) note(waypoints[i]);
    begin_at((count > 0 ? waypoints.back().time : from + milliseconds(900)) + kInterval);
  }

  void append() {
    const double x = position(next_);
    const Waypoint waypoint{.time = next_, .position = {&x, 1}};
    ASSERT_EQ(producer_.append(waypoint), AppendStatus::accepted);
    note(waypoint);
    next_ += kInterval;
  }

  void step() {
    while (solver_->step(clock).consumed > 0) {
    }
  }

  void finish() {
    ASSERT_EQ(producer_.finish({.kind = ConditionKind::halt, .value = {}}), AppendStatus::accepted);
    starve(milliseconds(600));
  }

  [[nodiscard]] const ipc::Summary& summary() const { return ipc::Internals::summary(*solver_); }

  /// The waypoints that were sent, without those that a replacement has replaced.
  [[nodiscard]] std::vector<std::pair<Time, double>> rows() const {
    std::vector<std::pair<Time, double>> found;
    for (const CopiedRow& row : rows_) found.emplace_back(row.time, row.position[0]);
    return found;
  }

  StoppedClock clock;

 private:
  void attach() {
    solver_.emplace(name_, SolverOptions{});
    EXPECT_TRUE(solver_->attach(clock));
  }
  [[nodiscard]] double position(Time t) const { return std::sin(2 * to_seconds(t)) + shift_; }
  void note(const Waypoint& waypoint) {
    rows_.push_back({.time = waypoint.time, .position = {waypoint.position[0]}});
  }

  std::string name_;
  Producer producer_;
  std::optional<Solver> solver_;
  Time next_{};
  double shift_ = 0;
  std::vector<CopiedRow> rows_;
};

class RecordLive : public RecorderTest {
 protected:
  /// Records a source while `run` uses it. Returns what verification finds of the stream.
  nlohmann::json record(LiveSource& source, const std::function<void()>& run, int code = 0) {
    Process recorder = start_recorder({name(), "-o", path()});
    recorder.await_message("'" + name() + "': recording");
    run();
    source.finish();
    recorder.signal(SIGINT);
    EXPECT_EQ(recorder.wait().code, 0);
    const Verified found = verify(path());
    EXPECT_EQ(found.code, code) << found.err << found.json.dump(1);
    return found.stream(name());
  }
  [[nodiscard]] std::string path() const { return folder_.path("run.mcap"); }
  [[nodiscard]] const std::string& name() const { return stream_.name(); }

  /// How many events of a kind the recording has.
  [[nodiscard]] std::size_t events(const std::string& kind) const {
    return static_cast<std::size_t>(
        std::ranges::count_if(messages_of(path(), "/" + name() + "/events"),
                              [&](const auto& event) { return event["event"] == kind; }));
  }

 private:
  TestFolder folder_;
  TestStream stream_;
};

TEST_F(RecordLive, ReplacementsStarvationAndATakeoverVerifyAndReadBackWithoutWhatWasReplaced) {
  LiveSource source(name());
  const auto found = record(source, [&] {
    source.run(milliseconds(200), milliseconds(200));
    source.replace(milliseconds(60), 20);
    source.run(milliseconds(200), milliseconds(200));
    source.starve(milliseconds(1000));
    source.begin_at(source.clock.now() + milliseconds(600));
    source.run(milliseconds(800), milliseconds(600));
    source.replace(milliseconds(300), 5);
    source.replace(milliseconds(50), 30);  // reaches back further than the one before
    source.take_over();
    source.run(milliseconds(300), milliseconds(300));
    source.replace(milliseconds(30), 0);  // a stop
    source.run(milliseconds(700), milliseconds(600));
  });
  EXPECT_GT(found["equal"], 50);
  if (found["late_commits"] == 0) {
    EXPECT_EQ(found["unverified"], 0);
  }
  EXPECT_GE(events("underrun"), 1U);
  EXPECT_EQ(events("takeover"), 1U);
  EXPECT_GE(events("returned"), 2U);  // of the replacement and after the starvation
  if (!apps::can_read_json()) return;
  std::vector<std::pair<Time, double>> rows;
  for (const CopiedRow& row : rows_of(path(), {.topic = name()}).rows) {
    rows.emplace_back(row.time, row.position[0]);
  }
  EXPECT_EQ(rows, source.rows());
}

TEST_F(RecordLive, ASampleOfTheFileHasTheBitsAndStatusesThatAReaderGot) {
  LiveSource source(name());
  std::vector<LiveRow> rows;
  (void)record(source, [&] {
    LiveReader reader(name());
    source.run(milliseconds(500), milliseconds(200));
    source.starve(milliseconds(1000));
    source.begin_at(source.clock.now() + milliseconds(600));
    source.run(milliseconds(900), milliseconds(600));
    source.replace(milliseconds(100), 30);
    source.run(milliseconds(200), milliseconds(200));
    source.starve(milliseconds(300));  // until nothing but what has settled can be sampled
    rows = reader.stop();
  });
  if (events("late") > 0) return;  // on a slow machine: the curve has changed after a sample
  EXPECT_GT(expect_sampled_alike(path(), name(), rows), 200U);
}

TEST_F(RecordLive, StopsOfStoppersVerifyAndAreEvents) {
  LiveSource source(name());
  Stopper panel(name(), "panel");
  Stopper second(name(), "second");
  const auto found = record(source, [&] {
    source.run(milliseconds(300), milliseconds(200));
    for (Stopper* stopper : {&panel, &second}) {
      (void)stopper->stop();
      source.starve(milliseconds(100));
      EXPECT_EQ(source.summary().holders, 1U);
      source.take_over();
      source.starve(milliseconds(300));
      (void)stopper->release();
      source.starve(milliseconds(20));
      EXPECT_EQ(source.summary().holders, 0U);
      source.begin_at(source.clock.now() + milliseconds(700));
      source.run(milliseconds(1200), milliseconds(600));
    }
  });
  EXPECT_GT(found["equal"], 50);
  if (found["late_commits"] == 0) {
    EXPECT_EQ(found["unverified"], 0);
  }
  EXPECT_EQ(events("stopped"), 2U);
  EXPECT_EQ(events("released"), 2U);
}

TEST_F(RecordLive, ARunWithLateCommitsVerifiesWhereThesePermitIt) {
  LiveSource source(name());
  const auto found = record(
      source,
      [&] {
        constexpr Time kLead = milliseconds(100);
        // On a slow machine a revision may miss its deadline instead: then there is another try.
        for (int i = 0; i < 400 && source.summary().late_commits < 3; ++i) {
          source.run(milliseconds(200), kLead);
          source.append();
          // The first reading looks for stoppers, the second one begins a step, the third one is
          // directly before the commit.
          source.clock.stop_after(3, milliseconds(150));
          source.step();
          source.begin_at(source.clock.now() + 4 * kLead);
        }
        ASSERT_GE(source.summary().late_commits, 3U);
        const ipc::Word before = source.summary().interpolated();
        for (int i = 0; i < 40 && source.summary().interpolated() < before + 100; ++i) {
          source.run(milliseconds(1500), 4 * kLead);
        }
      },
      5);
  EXPECT_GE(found["late_commits"], 1);
  EXPECT_TRUE(found["difference"].is_null());
  // After the last one verification begins again where the board has the knots that it needs.
  EXPECT_GT(found["equal"], 70) << found.dump(1);
  EXPECT_GE(events("late"), 1U);
}

}  // namespace
}  // namespace splinecast::testing
