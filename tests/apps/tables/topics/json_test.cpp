#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "apps/messages/json_fields.hpp"
#include "tests/fixtures/messages/mcap_file.hpp"
#include "tests/fixtures/messages/rows_of.hpp"
#include "tests/fixtures/processes/built_with.hpp"
#include "tests/fixtures/processes/process.hpp"

/// Rows of JSON channels of MCAP files.
namespace splinecast::apps {
namespace {

using namespace std::chrono_literals;
using testing::CopiedRows;
using testing::McapFile;
using testing::refusal_of;
using testing::rows_of;

using Names = std::vector<std::string>;
using Table = std::vector<std::vector<double>>;

constexpr Time kLog = 1'700'000'000s;

class JsonTopics : public ::testing::Test {
 protected:
  void SetUp() override {
    REQUIRE_MCAP();
    if (!can_read_json()) GTEST_SKIP() << "built without simdjson";
  }
  [[nodiscard]] std::string path() const { return folder_.path("log.mcap"); }
  /// A file with these messages, one second apart.
  void write(const std::vector<std::string>& messages) const {
    McapFile file(path());
    const auto topic = file.channel("/pose", "foxglove.PoseInFrame", "json");
    Time t = kLog;
    for (const std::string& message : messages) {
      file.write(topic, t, message);
      t += 1s;
    }
    file.finish();
  }

 private:
  testing::TestFolder folder_;
};

TEST_F(JsonTopics, OfFoxgloveHaveAPoseAndATimestamp) {
  write(
      {R"({"timestamp": {"sec": 12, "nsec": 500000000}, "frame_id": "map", "pose": {"position": {"x": 1, "y": 2, "z": 3}, "orientation": {"x": 0, "y": 0, "z": 0.6, "w": 0.8}}})",
       R"({"pose": {"orientation": {"w": 1, "x": 0, "y": 0, "z": 0}, "position": {"x": 4, "y": 5, "z": 6}}, "timestamp": {"nsec": 7, "sec": 13}})"});
  const CopiedRows read = rows_of(path());
  EXPECT_EQ(read.names,
            (Names{"pose.position.x", "pose.position.y", "pose.position.z", "pose.orientation.x",
                   "pose.orientation.y", "pose.orientation.z", "pose.orientation.w"}));
  EXPECT_EQ(read.positions(), (Table{{1, 2, 3, 0, 0, 0.6, 0.8}, {4, 5, 6, 0, 0, 0, 1}}));
  EXPECT_EQ(read.times(), (std::vector<Time>{12'500ms, 13s + 7ns}));
  EXPECT_EQ(read.kinds[2].kind, DimensionKind::linear);
  EXPECT_EQ(read.kinds[3].kind, DimensionKind::quaternion);
}

TEST_F(JsonTopics, GiveTheFieldsThatAreChosen) {
  write({R"({"t": 1, "pose": {"x": 1.5}, "joints": [10, 20]})",
         R"({"joints": [30, 40], "pose": {"x": 2.5}})"});
  const CopiedRows read = rows_of(path(), {.fields = {"joints[1]", "pose.x", "joints.0"}});
  EXPECT_EQ(read.names, (Names{"joints[1]", "pose.x", "joints[0]"}));
  EXPECT_EQ(read.positions(), (Table{{20, 1.5, 10}, {40, 2.5, 30}}));
  EXPECT_EQ(read.times(), (std::vector<Time>{kLog, kLog + 1s})) << "the log time";
  EXPECT_NE(refusal_of(path(), {.fields = {"a..b"}}).find("'a..b' is not the path of a field"),
            std::string::npos);
}

TEST_F(JsonTopics, HaveTheTimeOfAFieldWithEveryDigit) {
  write({R"({"t": 1403636579.763555584, "t_us": 3, "x": 1})"});
  EXPECT_EQ(rows_of(path(), {.time_column = "t", .fields = {"x"}}).times(),
            (std::vector<Time>{Time(1403636579763555584)}));
  EXPECT_EQ(rows_of(path(), {.time_column = "t_us", .fields = {"x"}}).times(),
            (std::vector<Time>{3us}));
  EXPECT_EQ(
      rows_of(path(), {.time_unit = TimeUnit::milliseconds, .time_column = "t_us", .fields = {"x"}})
          .times(),
      (std::vector<Time>{3ms}));
}

TEST_F(JsonTopics, WithAFieldThatIsMissingAreBadRows) {
  write({R"({"x": 1, "stamp": {"sec": 1, "nanosec": 0}})", R"({"stamp": {"sec": 2, "nanosec": 0}})",
         R"({"x": "red\u001b[31m", "stamp": {"sec": 3, "nanosec": 0}})", R"({"x": 1})", "{",
         R"({"x": 1, "stamp": {"sec": 4, "nanosec": 1000000000}})",
         R"({"x": 2, "stamp": {"sec": 5, "nanosec": 0}})"});
  const CopiedRows read = rows_of(path());
  EXPECT_EQ(read.positions(), (Table{{1}, {2}}));
  EXPECT_EQ(read.times(), (std::vector<Time>{1s, 5s}));
  ASSERT_EQ(read.errors.size(), 5U);
  const std::string where = path() + ": message ";
  EXPECT_EQ(read.errors[0], where + "2 of /pose: there is no number 'x'");
  EXPECT_TRUE(read.errors[1].starts_with(where + "3 of /pose: field 'x': "));
  EXPECT_EQ(read.errors[2], where + "4 of /pose: field 'stamp': a missing value is not a time");
  EXPECT_TRUE(read.errors[3].starts_with(where + "5 of /pose: not JSON"));
  EXPECT_EQ(read.errors[4], where + "6 of /pose: field 'stamp': 4 is not a time");
}

TEST_F(JsonTopics, WithTooManyNumbersNeedAChoice) {
  std::string values = "0";
  for (int i = 1; i < 65; ++i) values += ", 1";
  write({"{\"x\": [" + values + "]}"});
  EXPECT_EQ(refusal_of(path()),
            path() + ": topic /pose: its messages have 65 numbers: choose 1 to 64 with --field");
  EXPECT_EQ(rows_of(path(), {.fields = {"x[64]"}}).positions(), (Table{{1}}));
  write({R"({"text": "none"})"});
  EXPECT_NE(refusal_of(path()).find("have 0 numbers"), std::string::npos);
}

}  // namespace
}  // namespace splinecast::apps
