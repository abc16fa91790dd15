#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "ipc/layout/summary.hpp"
#include "ipc/memory/names.hpp"
#include "ipc/ring/writer.hpp"
#include "ipc/roles/internals.hpp"
#include "splinecast/clock.hpp"
#include "splinecast/producer.hpp"
#include "splinecast/reader.hpp"
#include "splinecast/solver.hpp"
#include "splinecast/streams.hpp"
#include "tests/apps/streams/life.hpp"

/// The life of a stream with real processes: start order, pauses, refused processes, removal.
namespace splinecast::apps {
namespace {

using ipc::RegionKind;

TEST_F(Life, EveryStartOrderGivesTheCompleteStream) {
  const std::vector<std::string> orders[] = {
      {"solve", "replay", "sample"}, {"solve", "sample", "replay"}, {"replay", "solve", "sample"},
      {"replay", "sample", "solve"}, {"sample", "solve", "replay"}, {"sample", "replay", "solve"}};
  for (const auto& order : orders) {
    const TestStream stream;
    std::vector<Process> processes;
    const auto index_of = [&](const std::string& verb) {
      return static_cast<std::size_t>(std::ranges::find(order, verb) - order.begin());
    };
    for (const std::string& verb : order) {
      auto arguments = verb == "solve" ? solve() : verb == "replay" ? replay() : sample();
      std::ranges::replace(arguments, name(), stream.name());
      processes.emplace_back(arguments);
      if (verb == "solve") processes.back().await_message(stream.name());
      if (verb == "replay") {
        // The next process starts when the producer's region exists.
        EXPECT_TRUE(await([&] {
          return std::filesystem::exists(ipc::region_path(stream.name(), RegionKind::waypoints));
        }));
      }
    }
    expect_all_sent(processes[index_of("replay")]);
    expect_all_sampled(processes[index_of("sample")]);
  }
}

TEST_F(Life, APausedSolverBlocksTheProducerAndNothingIsLost) {
  Process solver(solve());
  solver.await_message("waiting");
  Process replaying({"replay", file_, "--stream", name(), "--rate", "max", "--clock", "recorded",
                     "--capacity", "64", "--wait", "1"});
  ASSERT_TRUE(await([&] { return field("solver", "interpolated") > 100; }));
  solver.signal(SIGSTOP);
  ipc::Word before = 0;
  // Full except for the reserve for control items: the producer waits until the solver continues.
  const ipc::Word full_ring = 64 - ipc::control_reserve(64);
  const bool full = await([&] {
    const auto now = info(name());
    before = now["producer"]["appended"];
    return before - now["solver"]["consumed"].get<ipc::Word>() >= full_ring || before == 2001;
  });
  EXPECT_TRUE(full);
  solver.signal(SIGCONT);
  expect_all_sent(replaying);
  Process sampling(sample());
  expect_all_sampled(sampling);
}

TEST_F(Life, APausedProducerDelaysNoOtherProcess) {
  Process solver(solve());
  Process replaying({"replay", file_, "--stream", name(), "--rate", "1", "--clock", "recorded",
                     "--duration", "2"});
  ASSERT_TRUE(await([&] { return field("solver", "interpolated") > 20; }));
  replaying.signal(SIGSTOP);
  ASSERT_TRUE(await([&] {
    const auto now = info(name());
    return now["producer"]["appended"] == now["solver"]["consumed"];
  }));
  Reader reader(name());
  State state(reader.dimensions());
  ipc::Summary summary;
  ASSERT_TRUE(ipc::Internals::summary(reader, summary));
  EXPECT_EQ(reader.sample(summary.newest_time - Time(1), state), SampleStatus::provisional);
  EXPECT_EQ(reader.sample(summary.newest_time, state), SampleStatus::stopping);
  EXPECT_EQ(reader.sample(summary.newest_time + Time(1'000'000'000), state), SampleStatus::holding);
  EXPECT_TRUE(reader.alive().producer);
  EXPECT_TRUE(reader.alive().solver);
  replaying.signal(SIGCONT);
  EXPECT_EQ(replaying.wait().code, 0);
}

TEST_F(Life, ASecondProducerAndASecondSolverAreRefusedWithThePidOfTheFirst) {
  Process solver(solve());
  Process replaying({"replay", file_, "--stream", name(), "--rate", "1"});
  solver.await_message("solving");
  const Ended second_solver = run(solve());
  EXPECT_EQ(second_solver.code, 1);
  EXPECT_NE(second_solver.err.find("has a living solver (process " + std::to_string(solver.pid())),
            std::string::npos)
      << second_solver.err;
  const Ended second_producer = run(replay());
  EXPECT_EQ(second_producer.code, 1);
  EXPECT_NE(
      second_producer.err.find("has a living producer (process " + std::to_string(replaying.pid())),
      std::string::npos)
      << second_producer.err;
  const Ended removal = run({"rm", name()});
  EXPECT_EQ(removal.code, 1);
  EXPECT_NE(removal.err.find("has a living producer"), std::string::npos) << removal.err;
  EXPECT_TRUE(info(name())["producer"]["alive"]);
}

TEST_F(Life, ANewSolverIsRefusedWhileTheFirstStillWaitsForAProducer) {
  Process solver(solve());
  solver.await_message("waiting for a producer");
  EXPECT_EQ(run(solve()).code, 1);
  EXPECT_EQ(run({"rm", name()}).code, 1);
  solver.signal(SIGINT);
  EXPECT_EQ(solver.wait().code, 0);
  EXPECT_FALSE(std::filesystem::exists(ipc::lock_path(name(), RegionKind::spline)));
}

TEST_F(Life, RemovingAStreamMakesItsReadersAttachAgain) {
  {
    Process solver(solve());
    ASSERT_EQ(run(replay()).code, 0);
  }
  Reader reader(name());
  State state(reader.dimensions());
  EXPECT_EQ(reader.sample(Time(1000), state), SampleStatus::settled);
  EXPECT_FALSE(reader.alive().solver);
  ASSERT_EQ(run({"rm", name()}).code, 0);
  EXPECT_EQ(reader.sample(Time(1000), state), SampleStatus::retired);
  EXPECT_EQ(reader.wait(Time(1)), WaitStatus::retired);
  for (const RegionKind kind : {RegionKind::waypoints, RegionKind::spline}) {
    EXPECT_FALSE(std::filesystem::exists(ipc::region_path(name(), kind)));
    EXPECT_FALSE(std::filesystem::exists(ipc::lock_path(name(), kind)));
  }
  EXPECT_EQ(run({"rm", name()}).code, 4);
  EXPECT_EQ(run({"info", name()}).code, 4);
  EXPECT_EQ(run({"sample", name(), "--at", at_, "--wait", "0.1"}).code, 4);
}

TEST_F(Life, AReaderIsWokenWhenItsStreamIsRemoved) {
  {
    Process solver(solve());
    ASSERT_EQ(run(replay()).code, 0);
  }
  Reader reader(name());
  EXPECT_EQ(reader.wait(Time(1)), WaitStatus::advanced);
  EXPECT_EQ(reader.wait(Time(1)), WaitStatus::timed_out);
  Process removal({"rm", name()});
  EXPECT_EQ(reader.wait(Time(60'000'000'000)), WaitStatus::retired);
  EXPECT_EQ(removal.wait().code, 0);
}

TEST_F(Life, AReplayOntoAFinishedStreamRecreatesItAndReadersAttachAgain) {
  Process solver(solve());
  ASSERT_EQ(run(replay()).code, 0);
  const auto first = info(name());
  Reader reader(name());
  State state(reader.dimensions());
  Process again(replay());
  expect_all_sent(again);
  EXPECT_NE(info(name())["stream_id"], first["stream_id"]);
  EXPECT_EQ(reader.sample(Time(1000), state), SampleStatus::retired);
  reader = Reader(name());
  EXPECT_EQ(reader.sample(Time(1000), state), SampleStatus::settled);
  Process sampling(sample());
  expect_all_sampled(sampling);
}

TEST_F(Life, AReplayOntoAFinishedStreamKeepsItUntilASolverAttaches) {
  {
    Process solver(solve());
    ASSERT_EQ(run(replay()).code, 0);
  }
  const auto first = info(name());
  auto hasty = replay();
  hasty.insert(hasty.end(), {"--wait", "0.1"});
  EXPECT_EQ(run(hasty).code, 4);
  EXPECT_EQ(info(name())["stream_id"], first["stream_id"]);
  EXPECT_EQ(info(name())["state"], "finished");
  Process again(replay());
  Reader reader(name());
  State state(reader.dimensions());
  EXPECT_EQ(reader.sample(Time(1000), state), SampleStatus::settled);
  Process solver(solve());
  expect_all_sent(again);
  EXPECT_NE(info(name())["stream_id"], first["stream_id"]);
  Process sampling(sample());
  expect_all_sampled(sampling);
}

TEST_F(Life, ALoopShiftsTimesByTheDurationPlusTheMedianInterval) {
  const auto file = folder_.write("loop.csv", "t,x\n1,0\n1.5,1\n2,0\n");
  Process solver(solve());
  ASSERT_EQ(run({"replay", file, "--stream", name(), "--clock", "recorded", "--rate", "max",
                 "--loop", "3"})
                .code,
            0);
  const auto now = info(name());
  EXPECT_EQ(now["solver"]["interpolated"], 9);
  EXPECT_EQ(now["solver"]["newest_knot_ns"], 5'000'000'000);
}

TEST_F(Life, ALiveStreamPlaysNowAndStartsAndEndsAtRest) {
  Process solver(solve());
  Process replaying({"replay", file_, "--stream", name(), "--duration", "1", "--lead", "3000"});
  Reader reader(name(), Time(30'000'000'000));
  State state(reader.dimensions());
  while (reader.sample(Time(0), state) == SampleStatus::no_data) {
    ASSERT_NE(reader.wait(Time(60'000'000'000)), WaitStatus::timed_out);
  }
  const Time now = MonotonicClock().now();
  EXPECT_EQ(reader.sample(Time(0), state), SampleStatus::holding);
  const auto oldest = reader.first_time();
  ASSERT_TRUE(oldest.has_value());
  const Time first = *oldest;
  EXPECT_LT(first - now, Time(3'000'000'000));
  ASSERT_EQ(replaying.wait().code, 0);
  ipc::Summary summary;
  ASSERT_TRUE(ipc::Internals::summary(reader, summary));
  for (const Time end : {first, summary.newest_time + summary.end_lateness}) {
    EXPECT_TRUE(has_values(reader.sample(end, state)));
    for (const double v : state.velocity()) EXPECT_NEAR(v, 0, 1e-9);
    for (const double a : state.acceleration()) EXPECT_NEAR(a, 0, 1e-5);
  }
  const Ended sampled = run({"sample", name(), "--rate", "1000", "--count", "5"});
  EXPECT_EQ(sampled.code, 0);
  EXPECT_EQ(std::ranges::count(sampled.out, '\n'), 6);
}

TEST_F(Life, OneSolverProcessServesSeveralStreams) {
  const TestStream second;
  Process solver({"solve", name(), second.name()});
  ASSERT_EQ(run(replay()).code, 0);
  auto other = replay();
  std::ranges::replace(other, name(), second.name());
  ASSERT_EQ(run(other).code, 0);
  const Ended list = run({"ls", "--json"});
  EXPECT_EQ(list.code, 0);
  std::size_t finished = 0;
  for (const auto& entry : nlohmann::json::parse(list.out)) {
    const bool ours = entry["stream"] == name() || entry["stream"] == second.name();
    if (ours && entry["state"] == "finished") ++finished;
  }
  EXPECT_EQ(finished, 2U);
}

TEST_F(Life, AHistoryShorterThanTheStreamLimitsTheSampledTimes) {
  Process solver({"solve", name(), "--capacity", "32"});
  // Paced, so that the finish is a separate revision.
  ASSERT_EQ(
      run({"replay", file_, "--stream", name(), "--clock", "recorded", "--duration", "1"}).code, 0);
  const Ended sampled = run({"sample", name(), "--rate", "1000", "--count", "5"});
  EXPECT_EQ(sampled.code, 0) << sampled.err;
  EXPECT_EQ(testing::count_status(sampled.out, "settled"), 5U);
  const auto before = folder_.write("before.csv", "t_ns\n0\n5\n");
  const Ended past = run({"sample", name(), "--at", before});
  EXPECT_EQ(testing::count_status(past.out, "before history"), 2U) << past.out;
}

TEST_F(Life, ASignalStopsAReplayThatNeverWaits) {
  Process replaying({"replay", file_, "--stream", name(), "--rate", "max", "--clock", "recorded",
                     "--loop", "1000000", "--embedded"});
  ASSERT_TRUE(await([&] { return field("solver", "interpolated") > 2000; }));
  replaying.signal(SIGTERM);
  const Ended ended = replaying.wait();
  EXPECT_EQ(ended.code, 130);
  EXPECT_NE(ended.err.find("interrupted"), std::string::npos) << ended.err;
}

TEST_F(Life, SamplesOfALiveStreamAreWrittenImmediately) {
  Process solver(solve());
  Process replaying({"replay", file_, "--stream", name(), "--loop", "1000"});
  ASSERT_TRUE(await([&] { return field("solver", "interpolated") > 0; }));
  Process sampling({"sample", name(), "--rate", "0.0001", "--count", "2"});
  sampling.await_lines(2);  // the header and the first sample; the second one follows hours later
}

TEST_F(Life, ASignalToTheDemoStopsItAndItCleansUp) {
  Process demo({"demo", "--seconds", "1000"});
  const std::string stream = "demo." + std::to_string(demo.pid());
  ASSERT_TRUE(await([&] {
    const auto now = info(stream);
    return now.contains("solver") && now["solver"].is_object() &&
           now["solver"]["interpolated"] > 10;
  }));
  demo.signal(SIGTERM);
  EXPECT_EQ(demo.wait().code, 130);
  EXPECT_EQ(info(stream), nlohmann::json());
}

TEST_F(Life, BadNamesCountsAndRatesAreErrors) {
  for (const char* bad : {"../x", ".x", "", "a b"}) {
    EXPECT_EQ(run({"info", bad}).code, 2) << bad;
    EXPECT_EQ(run({"rm", bad}).code, 2) << bad;
    EXPECT_EQ(run({"solve", bad}).code, 2) << bad;
    EXPECT_EQ(run({"sample", bad, "--rate", "1", "--count", "1"}).code, 2) << bad;
  }
  for (const char* count : {"-1", "0", "x"}) {
    EXPECT_EQ(run({"sample", name(), "--rate", "1", "--count", count}).code, 2) << count;
  }
  for (const char* rate : {"nan", "0", "-1", "inf", "1e-12"}) {
    EXPECT_EQ(run({"sample", name(), "--rate", rate, "--count", "1"}).code, 2) << rate;
  }
  EXPECT_EQ(run({"replay", file_, "--stream", name(), "--capacity", "1"}).code, 2);
  EXPECT_FALSE(std::filesystem::exists(ipc::lock_path(name(), RegionKind::waypoints)));
}

TEST_F(Life, TruncatedOrNonUtf8NamesGiveValidJson) {
  std::string wide = "t,";
  for (int i = 0; i < 16; ++i) wide += "\xc3\xa9";
  const auto file = folder_.write("names.csv", wide + ",\xe9\n0,1,1\n1,2,2\n");
  ASSERT_EQ(run({"replay", file, "--stream", name(), "--clock", "recorded", "--rate", "max",
                 "--embedded"})
                .code,
            0);
  EXPECT_EQ(info(name())["names"][0].get<std::string>().size(), 30U);
  EXPECT_EQ(run({"ls", "--json"}).code, 0);
}

TEST_F(Life, TheDemoEndsWithAReportAndLeavesNoStream) {
  Process demo({"demo", "--seconds", "1", "--json"});
  const std::string own = "demo." + std::to_string(demo.pid());
  const Ended ended = demo.wait();
  ASSERT_EQ(ended.code, 0) << ended.err;
  const auto summary = nlohmann::json::parse(ended.out);
  EXPECT_EQ(summary["waypoints"]["sent"], summary["waypoints"]["interpolated"]);
  EXPECT_GE(summary["waypoints"]["sent"], 99);
  EXPECT_EQ(summary["readers"].size(), 2U);
  EXPECT_GT(summary["all_readers"]["by_status"][0], 0);
  EXPECT_LT(summary["all_readers"]["step_at_knots"][1], 1e-9);
  for (const std::string& stream : stream_names()) {
    EXPECT_FALSE(stream.starts_with(own)) << stream;
  }
}

/// Sends a motion of this length whose producer and solver then end. Returns when it comes to rest.
Time leave_motion(const std::string& stream, Time length) {
  constexpr int kWaypoints = 100;
  const MonotonicClock clock;
  const Time begin = clock.now() + std::chrono::milliseconds(20);
  Producer producer(stream, {.dimensions = 1});
  Solver solver(stream, {});
  for (int i = 0; i <= kWaypoints; ++i) {
    const double position = i;
    EXPECT_EQ(producer.append(
                  {.time = begin + i * (length / kWaypoints), .position = std::span(&position, 1)}),
              AppendStatus::accepted);
  }
  EXPECT_TRUE(solver.attach());
  while (solver.step(clock).consumed > 0) {
  }
  return begin + length;
}

TEST_F(Life, RmWaitsUntilAMotionWhoseWritersHaveEndedIsAtRest) {
  const MonotonicClock clock;
  // A slow machine may start `rm`, or read its message, when a short motion is over.
  for (Time length = std::chrono::seconds(1); length < std::chrono::minutes(10); length *= 4) {
    const Time end = leave_motion(name(), length);
    Reader reader(name());
    State state(1);
    EXPECT_TRUE(has_values(reader.preview(end, state)));
    Process removal({"rm", name()});
    const bool waits = removal.prints_message("waiting");
    const SampleStatus meanwhile = reader.preview(end, state);
    const bool is_before_end = clock.now() < end;
    const Ended ended = removal.wait();
    EXPECT_EQ(ended.code, 0) << ended.err;
    EXPECT_GE(clock.now(), end);
    EXPECT_EQ(reader.preview(end, state), SampleStatus::retired);
    EXPECT_TRUE(has_values(meanwhile) || !is_before_end) << to_string(meanwhile);
    if (waits && is_before_end) return;
  }
  FAIL() << "rm has never waited";
}

}  // namespace
}  // namespace splinecast::apps
