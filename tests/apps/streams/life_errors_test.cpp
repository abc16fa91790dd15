#include <gtest/gtest.h>

#include <csignal>
#include <string>
#include <vector>

#include "tests/apps/streams/life.hpp"

/// Errors in the life of a stream: no other process starts, writers die, rows are bad.
namespace splinecast::apps {
namespace {

TEST_F(Life, WithoutASolverReplayExitsWith4AndLeavesNoStream) {
  auto arguments = replay();
  arguments.insert(arguments.end(), {"--wait", "0.2"});
  const Ended ended = run(arguments);
  EXPECT_EQ(ended.code, 4);
  EXPECT_NE(ended.err.find("no solver for stream"), std::string::npos) << ended.err;
  EXPECT_EQ(info(name()), nlohmann::json());
}

TEST_F(Life, ReplayExitsWith4IfTheSolverIsKilledAndNotReplaced) {
  Process solver(solve());
  Process replaying({"replay", file_, "--stream", name(), "--rate", "1", "--clock", "recorded",
                     "--capacity", "4", "--wait", "0.3"});
  ASSERT_TRUE(await([&] { return field("solver", "interpolated") > 10; }));
  solver.signal(SIGKILL);
  const Ended ended = replaying.wait();
  EXPECT_EQ(ended.code, 4);
  EXPECT_NE(ended.err.find("has ended and no other attached"), std::string::npos) << ended.err;
}

TEST_F(Life, AKilledProducersStreamIsContinuedOnlyAtLaterTimes) {
  Process solver(solve());
  {
    Process replaying({"replay", file_, "--stream", name(), "--rate", "1", "--clock", "recorded"});
    ASSERT_TRUE(await([&] { return field("solver", "interpolated") > 20; }));
    replaying.signal(SIGKILL);
    EXPECT_EQ(replaying.wait().signal, SIGKILL);
  }
  const Ended from_the_start = run(replay());
  EXPECT_EQ(from_the_start.code, 2);
  EXPECT_NE(from_the_start.err.find("left unfinished by its producer at"), std::string::npos)
      << from_the_start.err;
  auto other_start = replay();
  other_start.insert(other_start.end(), {"--start", "halt", "--from", "15"});
  const Ended contradicting = run(other_start);
  EXPECT_EQ(contradicting.code, 2);
  EXPECT_NE(contradicting.err.find("start condition own, not halt"), std::string::npos)
      << contradicting.err;
  auto later = replay();
  later.insert(later.end(), {"--from", "15"});
  const Ended continued = run(later);
  EXPECT_EQ(continued.code, 0) << continued.err;
  const auto now = info(name());
  EXPECT_EQ(now["state"], "finished");
  EXPECT_GE(now["producer"]["epoch"], 2);
  EXPECT_EQ(now["solver"]["refused"], 0);
}

TEST_F(Life, ASolverThatTakesOverMayNotContradictTheBoard) {
  {
    Process solver({"solve", name(), "--settle", "4"});
    ASSERT_EQ(run(replay()).code, 0);
  }
  const Ended contradicting = run({"solve", name(), "--settle", "5"});
  EXPECT_EQ(contradicting.code, 2);
  EXPECT_NE(contradicting.err.find("settle lag 4, not 5"), std::string::npos) << contradicting.err;
  Process agreeing({"solve", name(), "--settle", "4"});
  agreeing.await_message("taken over");
}

TEST_F(Life, InfoLeavesOutWhatIsZeroOrEmptyUnlessAsked) {
  const Ended sent = run(
      {"replay", file_, "--stream", name(), "--clock", "recorded", "--rate", "max", "--embedded"});
  ASSERT_EQ(sent.code, 0) << sent.err;
  const std::string part = run({"info", name()}).out;
  const std::string all = run({"info", name(), "--all"}).out;
  for (const char* line : {"\n  refused  ", "\n  passed_over  ", "\n  lambda  "}) {
    EXPECT_EQ(part.find(line), std::string::npos) << line;
    EXPECT_NE(all.find(line), std::string::npos) << line;
  }
  EXPECT_EQ(part.find("null"), std::string::npos) << part;
  const std::size_t at = part.find("\n0 or empty ");
  ASSERT_NE(at, std::string::npos) << part;
  EXPECT_GT(std::stol(part.substr(at + 12)), 10);
  EXPECT_NE(part.find("(--all)", at), std::string::npos);
  EXPECT_NE(part.find("\n  interpolated  "), std::string::npos);
  EXPECT_NE(part.find("\n  starved                   false"), std::string::npos);
  EXPECT_EQ(all.find("0 or empty"), std::string::npos);
}

TEST_F(Life, ASolverThatTakesOverMayNotContradictHowALiveStreamIsSolved) {
  {
    Process solver({"solve", name(), "--freeze-ahead", "4", "--max-acceleration", "1e6,2e6",
                    "--history", "2", "--stop-time", "0.1"});
    // The long lead prevents late waypoints also on a machine that stalls for seconds.
    const Ended sent =
        run({"replay", file_, "--stream", name(), "--duration", "0.2", "--lead", "5000"});
    ASSERT_EQ(sent.code, 0) << sent.err;
    const auto live = info(name())["solver"];
    EXPECT_EQ(live["freeze_ahead_ns"], 4'000'000);
    EXPECT_EQ(live["min_entry_ns"], 4'000'000);
    EXPECT_EQ(live["history_ns"], 2'000'000'000);
    EXPECT_EQ(live["max_acceleration"], nlohmann::json({1e6, 2e6}));
    for (const char* counter : {"underruns", "deadline_misses", "late_commits", "withdrawn"}) {
      EXPECT_TRUE(live[counter].is_number()) << counter;
    }
    EXPECT_TRUE(live.contains("low_water_ns"));  // null if one step of the solver took all items
  }
  const std::vector<std::pair<std::vector<std::string>, std::string>> cases{
      {{"--freeze-ahead", "5"}, "freeze-ahead 4000000 ns, not 5000000 ns"},
      {{"--max-acceleration", "30"}, "acceleration limit"},
      {{"--history", "1"}, "history 2000000000 ns, not 1000000000 ns"},
      {{"--max-acceleration", "-1"}, "must be positive"},
      {{"--max-acceleration", "1,x"}, "is not a list of numbers"},
      {{"--freeze-ahead", "0"}, "'0' is not a number in the range 1 ns to 1 min"}};
  for (const auto& [arguments, message] : cases) {
    std::vector<std::string> solve{"solve", name()};
    solve.insert(solve.end(), arguments.begin(), arguments.end());
    const Ended ended = run(solve);
    EXPECT_EQ(ended.code, 2) << message;
    EXPECT_NE(ended.err.find(message), std::string::npos) << ended.err;
  }
}

TEST_F(Life, ALiveStreamEndsAtRest) {
  const Ended ended = run({"replay", file_, "--stream", name(), "--end", "natural"});
  EXPECT_EQ(ended.code, 2);
  EXPECT_NE(ended.err.find("a live stream ends at rest"), std::string::npos) << ended.err;
}

TEST_F(Life, AnInterruptedReplayFinishesItsStream) {
  Process solver(solve());
  Process replaying({"replay", file_, "--stream", name(), "--rate", "1", "--clock", "recorded"});
  ASSERT_TRUE(await([&] { return field("solver", "interpolated") > 20; }));
  replaying.signal(SIGINT);
  const Ended ended = replaying.wait();
  EXPECT_EQ(ended.code, 130);
  EXPECT_NE(ended.err.find("interrupted"), std::string::npos) << ended.err;
  EXPECT_TRUE(await([&] { return info(name())["state"] == "finished"; }));
}

TEST_F(Life, BadRowsStopAReplayBeforeAnythingIsSentOrAreListedAndSkipped) {
  const auto bad = folder_.write("bad.csv", "t,x\n1,1\n2,nan\n3,oops\n4,2\n4,3\n5,4\n");
  Process solver(solve());
  const Ended stopped = run({"replay", bad, "--stream", name(), "--clock", "recorded"});
  EXPECT_EQ(stopped.code, 2);
  EXPECT_NE(stopped.err.find("bad.csv:3: waypoint refused: not finite: column 'x': nan"),
            std::string::npos)
      << stopped.err;
  EXPECT_EQ(info(name()), nlohmann::json());
  const Ended skipped = run({"replay", bad, "--stream", name(), "--clock", "recorded", "--rate",
                             "max", "--on-error", "skip", "--json"});
  EXPECT_EQ(skipped.code, 0);
  for (const char* text : {"bad.csv:4:3", "bad.csv:3: waypoint refused: not finite",
                           "bad.csv:6: waypoint refused: duplicate"}) {
    EXPECT_NE(skipped.err.find(text), std::string::npos) << skipped.err;
  }
  const auto report = nlohmann::json::parse(skipped.out);
  EXPECT_EQ(report["sent"], 3);
  EXPECT_EQ(report["interpolated"], 3);
  EXPECT_EQ(report["skipped"], 3);
}

}  // namespace
}  // namespace splinecast::apps
