#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "splinecast/clock.hpp"
#include "splinecast/reader.hpp"
#include "splinecast/state.hpp"
#include "tests/fixtures/processes/process.hpp"

/// Where a replay to a live stream that exists already starts, in processes.
namespace splinecast::apps {
namespace {

using testing::Ended;
using testing::Process;

class ReplayStart : public ::testing::Test {
 protected:
  const std::string& name() const { return stream_.name(); }

  /// Replays a motion of 0.4 s from `from` to `to`.
  Ended replay(double from, double to, const std::vector<std::string>& options = {}) const {
    std::string text = "t,x\n";
    for (int i = 0; i <= 20; ++i) {
      const double part = 0.5 * (1 - std::cos(std::numbers::pi * i / 20));
      text += std::to_string(0.02 * i) + ',' + std::to_string(from + (to - from) * part) + '\n';
    }
    std::vector<std::string> all{
        "replay", folder_.write("line.csv", text), "--stream", name(), "--json", "--verify"};
    all.insert(all.end(), options.begin(), options.end());
    return testing::run(all);
  }

  double rest() const {
    Reader reader(name());
    State state(1);
    EXPECT_TRUE(
        has_values(reader.preview(MonotonicClock().now() + std::chrono::minutes(10), state)));
    return state.position()[0];
  }

 private:
  testing::TestStream stream_;
  testing::TestFolder folder_;
};

TEST_F(ReplayStart, ElsewhereSendsNothingAndNamesTheThreeWays) {
  Process solver({"solve", name()});
  ASSERT_EQ(replay(0, 0.4).code, 0);
  for (int i = 0; i < 2; ++i) {  // also if the solver has made the board of the first try
    const Ended ended = replay(-0.4, 0);
    EXPECT_EQ(ended.code, 2);
    for (const char* part : {"(0.4)", "(-0.4)", "--start-from old", "first", "VALUES"}) {
      EXPECT_NE(ended.err.find(part), std::string::npos) << part << ": " << ended.err;
    }
  }
  EXPECT_EQ(replay(0.4, 0.5).code, 0);
  EXPECT_NEAR(rest(), 0.5, 1e-9);
}

TEST_F(ReplayStart, FromTheOldEndLeadsAnEntryAndTheLeadGrowsByIt) {
  Process solver({"solve", name(), "--max-velocity", "2", "--max-acceleration", "40"});
  ASSERT_EQ(replay(0, 0.4).code, 0);
  const Ended ended = replay(-0.4, 0, {"--start-from", "old"});
  ASSERT_EQ(ended.code, 0) << ended.err;
  const nlohmann::json report = nlohmann::json::parse(ended.out);
  EXPECT_EQ(report["sent"], 21);
  EXPECT_EQ(report["interpolated"], 21);
  EXPECT_EQ(report["verification"]["difference"], nullptr) << ended.out;
  EXPECT_NEAR(rest(), 0, 1e-9);
  EXPECT_EQ(testing::info(name())["solver"]["excesses"].size(), 0U);
  // Near enough for an entry within the lead, without a word of the user.
  const Ended near = replay(0.02, 0.1, {"--lead", "500"});
  ASSERT_EQ(near.code, 0) << near.err;
  EXPECT_EQ(nlohmann::json::parse(near.out)["verification"]["difference"], nullptr) << near.out;
}

TEST_F(ReplayStart, FromTheFirstRowOrMeasuredValuesIsAsTheUserSays) {
  Process solver({"solve", name()});
  ASSERT_EQ(replay(0, 0.4, {"--start-from", "old"}).code, 0);  // there is no old end
  const Ended first = replay(-0.4, 0, {"--start-from", "first"});
  ASSERT_EQ(first.code, 0) << first.err;
  EXPECT_EQ(nlohmann::json::parse(first.out)["interpolated"], 21);
  const Ended measured = replay(0.9, 1, {"--start-from", "0.8"});
  ASSERT_EQ(measured.code, 0) << measured.err;
  EXPECT_EQ(nlohmann::json::parse(measured.out)["verification"]["difference"], nullptr)
      << measured.out;
  EXPECT_NEAR(rest(), 1, 1e-9);
  EXPECT_EQ(replay(0.9, 1, {"--start-from", "0.8,1"}).code, 2);
  EXPECT_EQ(replay(0.9, 1, {"--start-from", "here"}).code, 2);
  EXPECT_EQ(replay(0.9, 1, {"--start-from", "old", "--clock", "recorded"}).code, 2);
}

}  // namespace
}  // namespace splinecast::apps
