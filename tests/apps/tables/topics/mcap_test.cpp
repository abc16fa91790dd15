#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <regex>
#include <string>
#include <vector>

#include "apps/messages/ros.hpp"
#include "tests/fixtures/messages/cdr_writer.hpp"
#include "tests/fixtures/messages/mcap_file.hpp"
#include "tests/fixtures/messages/rows_of.hpp"
#include "tests/fixtures/messages/sampled_rows.hpp"
#include "tests/fixtures/processes/built_with.hpp"
#include "tests/fixtures/processes/process.hpp"

/// Rows of the topics of rosbag2's MCAP files.
namespace splinecast::apps {
namespace {

using namespace std::chrono_literals;
using testing::CopiedRow;
using testing::CopiedRows;
using testing::joint_state;
using testing::joint_trajectory;
using testing::McapFile;
using testing::refusal_of;
using testing::rows_of;
using testing::TestFolder;

using Names = std::vector<std::string>;
using Table = std::vector<std::vector<double>>;

constexpr Time kStart = 1'700'000'000s;
constexpr std::string_view kJointState = "sensor_msgs/msg/JointState";
constexpr std::string_view kTrajectory = "trajectory_msgs/msg/JointTrajectory";

class McapTopics : public ::testing::Test {
 protected:
  void SetUp() override {
    REQUIRE_MCAP();
    if (!ros::can_decode()) GTEST_SKIP() << "built without libfastcdr";
  }
  [[nodiscard]] std::string path() const { return folder_.path("log.mcap"); }

 private:
  TestFolder folder_;
};

TEST_F(McapTopics, JointsAreMatchedByNameAcrossMessages) {
  McapFile file(path());
  const auto topic = file.channel("/joint_states", kJointState);
  file.write(topic, kStart + 5ms, joint_state(kStart, {"a", "b", "c"}, {1, 2, 3}, {4, 5, 6}));
  file.write(topic, kStart + 15ms,
             joint_state(kStart + 10ms, {"c", "a", "b"}, {3.5, 1.5, 2.5}, {}));
  file.write(topic, kStart + 25ms,
             joint_state(kStart + 20ms, {"b", "extra", "c", "a"}, {12, 0, 13, 11}, {15, 0, 16, 14},
                         std::endian::big));
  file.finish();
  const CopiedRows read = rows_of(path());
  EXPECT_EQ(read.names, (Names{"a", "b", "c"}));
  EXPECT_EQ(read.rows,
            (std::vector<CopiedRow>{{1, kStart, {1, 2, 3}, {4, 5, 6}, {}},
                                    {2, kStart + 10ms, {1.5, 2.5, 3.5}, {}, {}},
                                    {3, kStart + 20ms, {11, 12, 13}, {14, 15, 16}, {}}}));
  EXPECT_TRUE(read.errors.empty());
}

TEST_F(McapTopics, JointsAreChosenAndOrdered) {
  McapFile file(path());
  const auto topic = file.channel("/joint_states", kJointState);
  file.write(topic, kStart, joint_state(kStart, {"a", "b", "c"}, {1, 2, 3}, {4, 5, 6}));
  file.finish();
  for (const bool by_columns : {false, true}) {
    TableOptions options;
    (by_columns ? options.columns : options.joints) = {"c", "a"};
    const CopiedRows read = rows_of(path(), options);
    EXPECT_EQ(read.names, (Names{"c", "a"}));
    EXPECT_EQ(read.rows, (std::vector<CopiedRow>{{1, kStart, {3, 1}, {6, 4}, {}}}));
  }
  EXPECT_EQ(refusal_of(path(), {.joints = {"c", "d"}}),
            path() + ": topic /joint_states: there is no joint 'd' among a, b, c");
  EXPECT_NE(refusal_of(path(), {.joints = {"c", "c"}}).find("'c' is chosen twice"),
            std::string::npos);
  EXPECT_NE(refusal_of(path(), {.columns = {"a"}, .joints = {"c"}}).find("only one of"),
            std::string::npos);
}

TEST_F(McapTopics, AMessageWithoutAJointOrAPositionIsABadRow) {
  McapFile file(path());
  const auto topic = file.channel("/joint_states", kJointState);
  file.write(topic, kStart, joint_state(kStart, {"a", "b"}, {1, 2}, {}));
  file.write(topic, kStart, joint_state(kStart + 1ms, {"a", "\x1b[31m"}, {1, 2}, {}));
  file.write(topic, kStart, joint_state(kStart + 2ms, {"a", "b"}, {}, {}));
  file.write(topic, kStart, std::string_view("\0\1\0\0", 4));
  file.write(topic, kStart, joint_state(kStart + 3ms, {"b", "a"}, {4, 3}, {}));
  file.finish();
  const CopiedRows read = rows_of(path());
  EXPECT_EQ(read.positions(), (Table{{1, 2}, {3, 4}}));
  EXPECT_EQ(read.rows.at(1).number, 5U);
  const std::string where = path() + ": message ";
  ASSERT_EQ(read.errors.size(), 3U);
  EXPECT_EQ(read.errors[0], where + "2 of /joint_states: there is no joint 'b'");
  EXPECT_EQ(read.errors[1], where + "3 of /joint_states: it has no positions");
  EXPECT_EQ(read.errors[2], where +
                                "4 of /joint_states: byte 4: the message ends before a number of 4 "
                                "bytes; bytes left: 0");
}

TEST_F(McapTopics, AGapAndABadRowAreNamedByTheirMessages) {
  McapFile file(path());
  const auto topic = file.channel("/joint_states", kJointState);
  for (const auto t : {0ms, 100ms, 200ms, 5200ms, 5300ms, 5300ms, 5400ms}) {
    file.write(topic, kStart + t, joint_state(kStart + t, {"a"}, {to_seconds(t)}, {}));
  }
  file.finish();
  const testing::TestStream stream;
  const std::vector<std::string> replay{
      "replay", path(),     "--stream", stream.name(), "--clock",    "recorded",   "--rate",
      "max",    "--settle", "1",        "--json",      "--embedded", "--on-error", "skip"};
  const testing::Ended reported = testing::run(replay);
  ASSERT_EQ(reported.code, 0) << reported.err;
  EXPECT_NE(reported.err.find(path() + ": message 6 of /joint_states: waypoint refused: duplicate"),
            std::string::npos)
      << reported.err;
  const auto report = nlohmann::json::parse(reported.out);
  EXPECT_EQ(report["gaps"]["longest"][0]["after"], 3);
  ASSERT_EQ(report["rows"].size(), 1U);
  EXPECT_EQ(report["rows"][0]["message"], 6);
  EXPECT_FALSE(report["rows"][0].contains("line"));
  const testing::Ended twice = testing::run({"fit", path(), "--dt", "1"});
  EXPECT_EQ(twice.code, 2);
  EXPECT_NE(twice.err.find("ns, the time of message 5"), std::string::npos) << twice.err;
  const testing::TestStream another;
  const testing::Ended text =
      testing::run({"replay", path(), "--stream", another.name(), "--clock", "recorded", "--rate",
                    "max", "--settle", "1", "--embedded", "--late", "pass"});
  EXPECT_NE(text.err.find("1 gap split, the longest 5 s from message 3 to message 4"),
            std::string::npos)
      << text.err;
}

TEST_F(McapTopics, TheTopicIsChosenIfTwoAreInterleaved) {
  for (const auto compression :
       {mcap::Compression::none, mcap::Compression::lz4, mcap::Compression::zstd}) {
    McapFile file(path(), compression, 500);
    const auto left = file.channel("/left", kJointState);
    const auto right = file.channel("/right", kJointState);
    const auto picture = file.channel("/camera", "sensor_msgs/msg/Image");
    for (int i = 0; i < 100; ++i) {
      const Time stamp = kStart + i * 10ms;
      file.write(left, stamp, joint_state(stamp, {"l"}, {i + 0.25}, {}));
      if (i % 2 == 0) file.write(right, stamp, joint_state(stamp, {"r"}, {-i - 0.5}, {1.0 * i}));
      file.write(picture, stamp, "picture");
    }
    file.finish();
    EXPECT_EQ(refusal_of(path()),
              path() +
                  ": choose one of the topics with --topic:"
                  "\n  /left (sensor_msgs/msg/JointState, cdr): 100 messages"
                  "\n  /right (sensor_msgs/msg/JointState, cdr): 50 messages"
                  "\n  /camera (sensor_msgs/msg/Image, cdr): 100 messages, no waypoints");
    EXPECT_NE(refusal_of(path(), {.topic = "/up"}).find("there is no topic '/up' among\n  /left"),
              std::string::npos);
    EXPECT_NE(refusal_of(path(), {.topic = "/camera"}).find("gives no waypoints"),
              std::string::npos);
    const CopiedRows read = rows_of(path(), {.topic = "/right"});
    ASSERT_EQ(read.rows.size(), 50U);
    for (int i = 0; i < 50; ++i) {
      const CopiedRow expected{
          static_cast<std::size_t>(i) + 1, kStart + i * 20ms, {-2.0 * i - 0.5}, {2.0 * i}, {}};
      EXPECT_EQ(read.rows[static_cast<std::size_t>(i)], expected);
    }
    EXPECT_EQ(rows_of(path(), {.topic = "/left"}).rows.size(), 100U);
  }
}

TEST_F(McapTopics, TheOnlyTopicWithWaypointsNeedsNoChoice) {
  McapFile file(path());
  file.write(file.channel("/camera", "sensor_msgs/msg/Image"), kStart, "picture");
  file.write(file.channel("/rosout", "rcl_interfaces/msg/Log"), kStart, "text");
  file.channel("/empty", kJointState);
  const auto topic = file.channel("/odom", "nav_msgs/msg/Odometry");
  file.write(topic, kStart, testing::odometry(kStart + 1ms, {1, 2, 3, 0, 0, 0, 1}));
  file.finish();
  EXPECT_EQ(rows_of(path()).positions(), (Table{{1, 2, 3, 0, 0, 0, 1}}));
}

TEST_F(McapTopics, AMessageOfATrajectoryReplacesTheFuture) {
  McapFile file(path());
  const auto topic = file.channel("/trajectory", kTrajectory);
  file.write(
      topic, kStart,
      joint_trajectory(kStart, {"a", "b"},
                       {{0s, {0, 10}}, {1s, {1, 11}, {2, 12}}, {2s, {2, 12}}, {3s, {3, 13}}}));
  file.write(topic, kStart,
             joint_trajectory(kStart + 2s, {"b", "a"}, {{500ms, {20, 30}, {21, 31}, {22, 32}}}));
  file.write(topic, kStart + 10s,
             joint_trajectory(Time::zero(), {"a", "b"}, {{1s, {5, 6}}, {2s, {7, 8}}}));
  file.write(topic, kStart + 20s, joint_trajectory(kStart + 11'500ms, {}, {}));
  file.finish();
  const std::vector<CopiedRow> expected{
      {1, kStart, {0, 10}, {}, {}},
      {1, kStart + 1s, {1, 11}, {2, 12}, {}},
      {2, kStart + 2'500ms, {30, 20}, {31, 21}, {32, 22}},
      {3, kStart + 11s, {5, 6}, {}, {}},  // the stamp 0 is the time of the log
  };
  EXPECT_EQ(rows_of(path()).rows, expected) << "an empty message stops the motion";
  const auto reader = open_rows(path(), {.quiet = true});
  for (int pass = 0; pass < 3; ++pass) {
    CopiedRows read;
    testing::copy_rows(*reader, read);
    EXPECT_EQ(read.rows, expected);
    reader->rewind();
    Row row;
    ASSERT_TRUE(reader->next(row));
    reader->rewind();
  }
}

TEST_F(McapTopics, PosesAreQuaternionsInBothByteOrders) {
  const std::vector<double> pose{1, 2, 3, 0.5, 0.5, -0.5, 0.5};
  for (const auto order : {std::endian::little, std::endian::big}) {
    McapFile file(path());
    const auto posed = file.channel("/pose", "geometry_msgs/msg/PoseStamped");
    const auto odom = file.channel("/odom", "nav_msgs/msg/Odometry");
    file.write(posed, kStart, testing::pose_stamped(kStart + 1ms, pose, order));
    file.write(odom, kStart, testing::odometry(kStart + 2ms, pose, order));
    file.finish();
    for (const std::string topic : {"/pose", "/odom"}) {
      const CopiedRows read = rows_of(path(), {.topic = topic});
      EXPECT_EQ(read.names, (Names{"x", "y", "z", "qx", "qy", "qz", "qw"}));
      EXPECT_EQ(read.positions(), (Table{pose}));
      EXPECT_EQ(read.kinds[2].kind, DimensionKind::linear);
      EXPECT_EQ(read.kinds[3].kind, DimensionKind::quaternion);
      EXPECT_EQ(read.kinds[6].kind, DimensionKind::quaternion);
      const CopiedRows some = rows_of(path(), {.columns = {"z", "x"}, .topic = topic});
      EXPECT_EQ(some.positions(), (Table{{3, 1}}));
    }
  }
}

TEST_F(McapTopics, TheTimeIsThatOfTheHeaderOfTheLogOrOfThePublication) {
  McapFile file(path());
  const auto topic = file.channel("/joint_states", kJointState);
  file.write(topic, kStart + 7ms, joint_state(kStart + 3ms, {"a"}, {1}, {}));
  file.finish();
  const auto time_by = [&](WhichTime which) {
    return rows_of(path(), {.which_time = which}).times();
  };
  EXPECT_EQ(time_by(WhichTime::header), (std::vector<Time>{kStart + 3ms}));
  EXPECT_EQ(time_by(WhichTime::log), (std::vector<Time>{kStart + 7ms}));
  EXPECT_EQ(time_by(WhichTime::publish), (std::vector<Time>{kStart + 6ms}));
}

TEST_F(McapTopics, AFileThatIsCutOffGivesTheRowsOfItsWholeChunks) {
  McapFile file(path(), mcap::Compression::zstd, 200);
  const auto topic = file.channel("/joint_states", kJointState);
  for (int i = 0; i < 20; ++i) {
    file.write(topic, kStart + i * 1s, joint_state(kStart + i * 1s, {"a"}, {1.0 * i}, {}));
  }
  file.cut();
  const auto size = std::filesystem::file_size(path());
  EXPECT_EQ(rows_of(path()).rows.size(), 20U);
  std::filesystem::resize_file(path(), size - 100);
  const CopiedRows read = rows_of(path());
  EXPECT_LT(read.rows.size(), 20U);
  EXPECT_GT(read.rows.size(), 10U);
  EXPECT_TRUE(read.errors.empty());
  const testing::Ended reported = testing::run({"fit", path(), "--dt", "1"});
  EXPECT_EQ(reported.code, 0);
  EXPECT_NE(reported.err.find("the file is cut off: read up to its last whole chunk"),
            std::string::npos);
}

TEST_F(McapTopics, ADamagedFileGivesTheRowsBeforeTheDamageAndOneError) {
  McapFile file(path(), mcap::Compression::none, 200);
  const auto topic = file.channel("/joint_states", kJointState);
  for (int i = 0; i < 20; ++i) {
    file.write(topic, kStart + i * 1s, joint_state(kStart + i * 1s, {"a"}, {1.0 * i}, {}));
  }
  file.finish();
  std::fstream damaged(path(), std::ios::in | std::ios::out | std::ios::binary);
  damaged.seekp(1500);
  damaged.put('!');
  damaged.close();
  const CopiedRows read = rows_of(path());
  EXPECT_GT(read.rows.size(), 0U);
  EXPECT_LT(read.rows.size(), 20U);
  ASSERT_EQ(read.errors.size(), 1U);
  EXPECT_TRUE(read.errors[0].starts_with(path())) << read.errors[0];
  EXPECT_NE(read.errors[0].find("byte"), std::string::npos) << read.errors[0];
  const testing::Ended refused =
      testing::run({"replay", path(), "--stream", "none", "--on-error", "skip"});
  EXPECT_EQ(refused.code, 2);
  EXPECT_NE(refused.err.find("splinecast recover keeps what can be read"), std::string::npos)
      << refused.err;
}

/// An output without the names of the files and of the rows, and without measured times.
std::string comparable(const std::string& text) {
  const std::regex where(
      R"([^ ,"]*/log\.csv(:(\d+))?|[^ ,"]*/log\.mcap(: message \d+ of [a-z_/]+)?)");
  return std::regex_replace(text, where, "FILE");
}

/// A file and a CSV with the same rows.
class SameRows : public McapTopics {
 protected:
  void SetUp() override {
    McapTopics::SetUp();
    if (IsSkipped()) return;
    std::ofstream csv(csv_path());
    csv << "t_ns,a,b,v[0],v[1]\n";
    McapFile file(path(), mcap::Compression::lz4, 1000);
    const auto topic = file.channel("/joint_states", kJointState);
    for (int i = 0; i < 200; ++i) {
      const Time t = kStart + i * 10ms;
      const double x = std::sin(0.1 * i);
      const double v = 10 * std::cos(0.1 * i);
      csv << fmt::format("{},{},{},{},{}\n", t.count(), x, 2 * x, v, 2 * v);
      file.write(topic, t + 1ms,
                 i % 3 == 0 ? joint_state(t, {"a", "b"}, {x, 2 * x}, {v, 2 * v})
                            : joint_state(t, {"b", "a"}, {2 * x, x}, {2 * v, v}));
    }
    file.finish();
  }
  [[nodiscard]] std::string csv_path() const { return folder_.path("log.csv"); }

 private:
  TestFolder folder_;
};

TEST_F(SameRows, AreFittedCheckedAndAdvisedAsThoseOfCsv) {
  using Words = std::vector<std::string>;
  for (const Words& words : {Words{"fit", "--dt", "0.003"}, Words{"check", "--max-velocity", "3"},
                             Words{"advise"}, Words{"fit", "--dt", "0.01", "--columns", "b"},
                             Words{"fit", "--dt", "0.01", "--kind", "a:periodic:1"}}) {
    Words on_mcap = words;
    Words on_csv = words;
    on_mcap.insert(on_mcap.begin() + 1, path());
    on_csv.insert(on_csv.begin() + 1, csv_path());
    const testing::Ended mcap = testing::run(on_mcap);
    const testing::Ended csv = testing::run(on_csv);
    EXPECT_EQ(mcap.code, csv.code) << mcap.err;
    EXPECT_FALSE(mcap.out.empty()) << mcap.err;
    EXPECT_EQ(comparable(mcap.out), comparable(csv.out)) << words[0];
  }
}

TEST_F(SameRows, OfCsvHaveNoTopic) {
  for (const TableOptions& options :
       {TableOptions{.topic = "/a"}, TableOptions{.fields = {"a"}}, TableOptions{.joints = {"a"}},
        TableOptions{.which_time = WhichTime::log}}) {
    EXPECT_EQ(
        refusal_of(csv_path(), options),
        csv_path() +
            ": is a text: --topic, --joints, --field and --time are for MCAP files and ULogs");
  }
}

TEST_F(SameRows, AreReplayedToTheValuesThatWerePutIn) {
  const testing::TestStream stream;
  const testing::Ended replayed =
      testing::run({"replay", path(), "--stream", stream.name(), "--clock", "recorded", "--rate",
                    "max", "--embedded", "--verify", "--method", "hermite"});
  EXPECT_EQ(replayed.code, 0) << replayed.err;
  const testing::Ended samples = testing::run({"sample", stream.name(), "--at", csv_path()});
  EXPECT_EQ(samples.code, 0) << samples.err;
  const CopiedRows rows = rows_of(csv_path());
  ASSERT_EQ(rows.rows.size(), 200U);
  testing::expect_sampled(samples.out, rows.rows);
}

}  // namespace
}  // namespace splinecast::apps
