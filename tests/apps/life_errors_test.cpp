#include <gtest/gtest.h>

#include <csignal>
#include <string>
#include <vector>

#include "life.hpp"

/// A stream's life when something goes wrong: nobody comes, writers die, rows are bad.
namespace splinecast::apps {
namespace {

TEST_F(Life, WithoutASolverReplayExitsWith4AndLeavesNothingBehind) {
  auto arguments = replay();
  arguments.insert(arguments.end(), {"--wait", "0.2"});
  const Ended ended = run(arguments);
  EXPECT_EQ(ended.code, 4);
  EXPECT_NE(ended.err.find("no solver for stream"), std::string::npos) << ended.err;
  EXPECT_EQ(info(name()), nlohmann::json());
}

TEST_F(Life, WhenTheSolverIsKilledAndNoneComesReplayExitsWith4) {
  Process solver(solve());
  Process replaying({"replay", file_, "--stream", name(), "--rate", "1", "--clock", "recorded",
                     "--capacity", "4", "--wait", "0.3"});
  ASSERT_TRUE(await([&] { return field("solver", "interpolated") > 10; }));
  solver.signal(SIGKILL);
  const Ended ended = replaying.wait();
  EXPECT_EQ(ended.code, 4);
  EXPECT_NE(ended.err.find("has gone"), std::string::npos) << ended.err;
}

TEST_F(Life, AKilledProducersStreamIsContinuedOnlyWhereTimeGoesOn) {
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

TEST_F(Life, AnInterruptedReplayFinishesItsStream) {
  Process solver(solve());
  Process replaying({"replay", file_, "--stream", name(), "--rate", "1", "--clock", "recorded"});
  ASSERT_TRUE(await([&] { return field("solver", "interpolated") > 20; }));
  replaying.signal(SIGINT);
  const Ended ended = replaying.wait();
  EXPECT_EQ(ended.code, 0);
  EXPECT_NE(ended.err.find("interrupted"), std::string::npos) << ended.err;
  EXPECT_TRUE(await([&] { return info(name())["state"] == "finished"; }));
}

TEST_F(Life, BadRowsStopAReplayBeforeAnythingIsSentOrAreSkippedByName) {
  const auto bad = folder_.write("bad.csv", "t,x\n1,1\n2,nan\n3,oops\n4,2\n4,3\n5,4\n");
  Process solver(solve());
  const Ended stopped = run({"replay", bad, "--stream", name(), "--clock", "recorded"});
  EXPECT_EQ(stopped.code, 2);
  EXPECT_NE(stopped.err.find("bad.csv:4:3: column 'x': 'oops' is not a number"), std::string::npos)
      << stopped.err;
  EXPECT_EQ(info(name()), nlohmann::json());
  const Ended skipped = run({"replay", bad, "--stream", name(), "--clock", "recorded", "--rate",
                             "max", "--on-error", "skip", "--json"});
  EXPECT_EQ(skipped.code, 0);
  for (const char* text : {"bad.csv:4:3", "bad.csv:3: waypoint refused: not finite",
                           "bad.csv:6: waypoint refused: not increasing"}) {
    EXPECT_NE(skipped.err.find(text), std::string::npos) << skipped.err;
  }
  const auto report = nlohmann::json::parse(skipped.out);
  EXPECT_EQ(report["sent"], 3);
  EXPECT_EQ(report["interpolated"], 3);
  EXPECT_EQ(report["skipped"], 3);
}

}  // namespace
}  // namespace splinecast::apps
