#include <fmt/format.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "splinecast/clock.hpp"
#include "splinecast/producer.hpp"
#include "tests/fixtures/processes/process.hpp"
#include "tests/fixtures/processes/shared_files.hpp"

/// The verb `advise`, and the warning of `info` about a depth that is too small.
namespace splinecast::apps {
namespace {

using nlohmann::json;
using std::chrono::milliseconds;
using testing::Ended;
using testing::own_file;
using testing::Process;
using testing::run;
using testing::TestFolder;
using testing::TestStream;

TEST(Advise, ReportsTheMeasurementsOfAFileAndTheAdvice) {
  const Ended ended = run({"advise", own_file("duplicates.csv"), "--json"});
  ASSERT_EQ(ended.code, 0) << ended.err;
  const json found = json::parse(ended.out);
  EXPECT_EQ(found["rows"], 100);
  EXPECT_EQ(found["intervals"]["median_ns"], 20'000'000);
  EXPECT_EQ(found["late"]["duplicate"], 15);
  EXPECT_EQ(found["dimensions"][0]["name"], "q1");
  EXPECT_EQ(found["dimensions"][0]["unit"], "rad");
  EXPECT_EQ(found["advice"]["depth_needed_ns"], 185'000'000);
  EXPECT_EQ(found["advice"]["lead_ns"], 200'000'000);
  EXPECT_EQ(found["advice"]["max_acceleration"].size(), 3U);
  EXPECT_EQ(found["hiccups"].size(), 4U);
  EXPECT_EQ(found["hiccups"][0]["dry_ns"], 0);
  EXPECT_TRUE(found["solver"].is_null());
  for (const char* key : {"lead", "settle", "freeze_ahead", "stop_time", "max_velocity"}) {
    EXPECT_FALSE(found["why"][key].get<std::string>().empty()) << key;
  }
}

TEST(Advise, PrintsTheSameAsTextWithUnits) {
  const Ended ended = run({"advise", own_file("gaps.csv"), "--settle", "4"});
  ASSERT_EQ(ended.code, 0) << ended.err;
  EXPECT_NE(ended.out.find("freeze-ahead 5 ms + 5 intervals of 20 ms = 105 ms"), std::string::npos);
  EXPECT_NE(ended.out.find("3 longer than 100 ms, at most 12000 ms"), std::string::npos);
  EXPECT_NE(ended.out.find("rad/s^2"), std::string::npos) << ended.out;
  EXPECT_NE(ended.out.find("silence of 300 ms, lead 60 ms: starves for 265 ms"), std::string::npos);
}

TEST(Advise, RefusesUnreadableInput) {
  const TestFolder folder;
  EXPECT_EQ(run({"advise", folder.path("none.csv")}).code, 2);
  EXPECT_NE(run({"advise", "none"}).err.find("neither a file nor a stream 'none'"),
            std::string::npos);
  EXPECT_EQ(run({"advise", own_file("not_finite.csv")}).code, 2);
  const Ended few = run({"advise", folder.write("a.csv", "t,x\n0,0\n1,1\n")});
  EXPECT_EQ(few.code, 2);
  EXPECT_NE(few.err.find("2 rows in order: advice needs at least 3"), std::string::npos) << few.err;
}

/// A live stream at 100 Hz whose first waypoints are sent immediately, `lead` before their time.
class AdviseStream : public ::testing::Test {
 protected:
  void send(Time lead, int rows) {
    Process& solver = solver_;
    solver.await_message("waiting");
    Producer& producer = *producer_;
    ASSERT_TRUE(producer.wait_for_solver(testing::kPatience));
    const Time start = MonotonicClock().now() + lead;
    for (int i = 0; i < rows; ++i) {
      const double x = 0.01 * i;
      ASSERT_EQ(producer.append({.time = start + i * milliseconds(10), .position = {&x, 1}}),
                AppendStatus::accepted);
      ASSERT_TRUE(producer.wait_until_consumed(testing::kPatience));
    }
  }
  static json of(const std::string& stream) {
    const Ended ended = run({"advise", stream, "--json"});
    EXPECT_EQ(ended.code, 0) << ended.err;
    return ended.code == 0 ? json::parse(ended.out) : json();
  }

  TestStream stream_;
  Process solver_{{"solve", stream_.name(), "--settle", "6", "--freeze-ahead", "10"}};
  std::optional<Producer> producer_{std::in_place, stream_.name(),
                                    ProducerOptions{.names = {"x"}, .units = {"m"}}};
};

TEST_F(AdviseStream, UsesTheItemsInTheRingAndTheOptionsOfTheStream) {
  send(std::chrono::seconds(20), 50);
  const json before = testing::info(stream_.name());
  const json found = of(stream_.name());
  EXPECT_EQ(found["rows"], 50);
  EXPECT_EQ(found["intervals"]["median_ns"], 10'000'000);
  EXPECT_EQ(found["dimensions"][0]["unit"], "m");
  EXPECT_NEAR(found["dimensions"][0]["velocity"].get<double>(), 1, 1e-9);
  EXPECT_EQ(found["solver"]["settle"], 6);
  EXPECT_EQ(found["solver"]["freeze_ahead_ns"], 10'000'000);
  EXPECT_EQ(found["advice"]["depth_needed_ns"], 80'000'000);
  EXPECT_EQ(testing::info(stream_.name())["producer"], before["producer"]);
  EXPECT_FALSE(before.contains("depth_warning"));
}

TEST_F(AdviseStream, InfoWarnsOfALeadThatIsTooShortForK) {
  send(milliseconds(40), 3);
  const Ended ended = run({"info", stream_.name(), "--json"});
  const json found = json::parse(ended.out);
  ASSERT_TRUE(found.contains("depth_warning")) << ended.out;
  EXPECT_NE(found["depth_warning"].get<std::string>().find("K = 6 needs 70 ms"), std::string::npos);
  EXPECT_NE(run({"info", stream_.name()}).out.find("depth_warning"), std::string::npos);
}

}  // namespace
}  // namespace splinecast::apps
