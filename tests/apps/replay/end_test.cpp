#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <string>
#include <vector>

#include "splinecast/clock.hpp"
#include "splinecast/reader.hpp"
#include "splinecast/state.hpp"
#include "tests/fixtures/processes/process.hpp"

/// How a replayed stream ends, in processes.
namespace splinecast::apps {
namespace {

using testing::Ended;
using testing::Process;

/// A recording of a line with a speed of 1, with a waypoint every 20 ms.
std::string line_of(int waypoints) {
  std::string text = "t,x\n";
  for (int i = 0; i < waypoints; ++i) {
    const std::string t = std::to_string(0.02 * i);
    text.append(t).append(",").append(t).append("\n");
  }
  return text;
}

class ReplayEnd : public ::testing::Test {
 protected:
  const std::string& name() const { return stream_.name(); }
  std::string file(int waypoints) const { return folder_.write("line.csv", line_of(waypoints)); }
  nlohmann::json solver() const { return testing::info(name())["solver"]; }

 private:
  testing::TestStream stream_;
  testing::TestFolder folder_;
};

TEST_F(ReplayEnd, AfterASignalIsWhereTheStopThatBeginsAtOnceRests) {
  Process solver_process({"solve", name()});
  Process replay({"replay", file(3000), "--stream", name(), "--lead", "5000", "--json"});
  Reader reader(name(), testing::kPatience);
  State state(1);
  const MonotonicClock clock;
  ASSERT_TRUE(testing::await(
      [&] { return has_values(reader.sample(clock.now(), state)) && state.position()[0] > 0.1; }));
  replay.signal(SIGINT);
  const Ended ended = replay.wait();
  EXPECT_EQ(ended.code, 130) << ended.err;
  const nlohmann::json board = solver();
  EXPECT_TRUE(board["finished"]);
  EXPECT_EQ(board["refused"], 0);
  ASSERT_TRUE(
      has_values(reader.sample(Time(board["settled_until_ns"]) + std::chrono::hours(1), state)));
  EXPECT_EQ(state.velocity()[0], 0);
  const double last_sent = 0.02 * (nlohmann::json::parse(ended.out)["sent"].get<int>() - 1);
  EXPECT_LT(state.position()[0], last_sent - 0.5);
}

TEST_F(ReplayEnd, ThatIsNotAsRequestedIsReported) {
  Process solver_process({"solve", name(), "--max-acceleration", "5"});
  const Ended ended = testing::run(
      {"replay", file(50), "--stream", name(), "--lead", "5000", "--json", "--verify"});
  EXPECT_EQ(ended.code, 0) << ended.err;
  const nlohmann::json end = nlohmann::json::parse(ended.out)["end"];
  EXPECT_EQ(end["kind"], "slowed");
  EXPECT_EQ(end["item"], 50);
  EXPECT_GT(end["lateness_ns"], 0);
  EXPECT_EQ(end, solver()["end"]);
  solver_process.await_message("slowed down on its path and rests at the last waypoint 0.");
}

}  // namespace
}  // namespace splinecast::apps
