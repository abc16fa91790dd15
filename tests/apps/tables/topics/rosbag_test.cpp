#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apps/messages/bytes.hpp"
#include "apps/messages/ros.hpp"
#include "tests/apps/mcap/npm_peers.hpp"
#include "tests/fixtures/messages/cdr_writer.hpp"
#include "tests/fixtures/messages/rows_of.hpp"
#include "tests/fixtures/messages/sampled_rows.hpp"

/// Files that @mcap/core writes, with messages in CDR and JSON as rosbag2 and Foxglove have them.
namespace splinecast::apps {
namespace {

using namespace std::chrono_literals;
using testing::CopiedRow;
using testing::CopiedRows;
using testing::Ended;
using testing::joint_state;
using testing::joint_trajectory;
using testing::rows_of;

constexpr Time kBagStart = 1'700'000'000s;
constexpr int kRows = 120;

double at(int i, double phase) { return std::sin(0.1 * i + phase); }

std::string hex(std::span<const std::byte> bytes) {
  std::string text;
  for (const std::byte byte : bytes) text += fmt::format("{:02x}", std::to_integer<int>(byte));
  return text;
}

class Rosbag : public testing::NpmPeersTest {
 protected:
  void SetUp() override {
    if (!ros::can_decode()) GTEST_SKIP() << "built without libfastcdr";
    NpmPeersTest::SetUp();
  }

  [[nodiscard]] std::string path() const { return folder_.path("rosbag.mcap"); }

  void add(const std::string& topic, const std::string& type, Time log_time,
           std::span<const std::byte> message, const std::string& encoding = "cdr") {
    messages_.push_back({topic, type, encoding, std::to_string(log_time.count()), hex(message)});
  }

  void write(const std::string& compression) const {
    const std::string list = folder_.write("messages.json", messages_.dump());
    const Ended ended = peer("rosbag.mjs", {path(), compression, list});
    ASSERT_EQ(ended.code, 0) << ended.err;
  }

  /// Two joints in changing order, every third message without velocities; poses between them.
  void add_interleaved() {
    for (int i = 0; i < kRows; ++i) {
      const Time t = kBagStart + i * 10ms;
      const double a = at(i, 0);
      const double b = at(i, 1);
      const auto order = i % 5 == 0 ? std::endian::big : std::endian::little;
      const auto velocities = [&](double first, double second) {
        return i % 3 == 0 ? testing::Values{} : testing::Values{2 * first, 2 * second};
      };
      add("/joint_states", "sensor_msgs/msg/JointState", t + 3ms,
          i % 2 == 0 ? joint_state(t, {"a", "b"}, {a, b}, velocities(a, b), order)
                     : joint_state(t, {"b", "a"}, {b, a}, velocities(b, a), order));
      const testing::Values pose{a, b, 3, 0, 0, std::sin(0.01 * i), std::cos(0.01 * i)};
      add("/pose", "geometry_msgs/msg/PoseStamped", t + 4ms,
          testing::pose_stamped(t + 1ms, pose, order));
      add("/odom", "nav_msgs/msg/Odometry", t + 5ms, testing::odometry(t + 2ms, pose, order));
      add("/target", "foxglove.Vector3", t + 6ms,
          bytes_of(fmt::format(R"({{"x":{},"y":{}}})", a, b)), "json");
    }
  }

 private:
  testing::TestFolder folder_;
  nlohmann::json messages_ = nlohmann::json::array();
};

TEST_F(Rosbag, TopicsGiveTheValuesThatWerePutIn) {
  add_interleaved();
  for (const std::string compression : {"none", "lz4", "zstd"}) {
    write(compression);
    const CopiedRows joints = rows_of(path(), {.topic = "/joint_states"});
    const CopiedRows poses = rows_of(path(), {.topic = "/pose"});
    const CopiedRows odometry = rows_of(path(), {.topic = "/odom"});
    const CopiedRows targets = rows_of(path(), {.topic = "/target"});
    ASSERT_EQ(joints.rows.size(), static_cast<std::size_t>(kRows));
    for (int i = 0; i < kRows; ++i) {
      const auto row = static_cast<std::size_t>(i);
      const double a = at(i, 0);
      const double b = at(i, 1);
      EXPECT_EQ(joints.rows[row].time, kBagStart + i * 10ms);
      EXPECT_EQ(joints.rows[row].position, (testing::Values{a, b}));
      EXPECT_EQ(joints.rows[row].velocity,
                i % 3 == 0 ? testing::Values{} : (testing::Values{2 * a, 2 * b}));
      const testing::Values pose{a, b, 3, 0, 0, std::sin(0.01 * i), std::cos(0.01 * i)};
      EXPECT_EQ(poses.rows.at(row).position, pose);
      EXPECT_EQ(poses.rows.at(row).time, kBagStart + i * 10ms + 1ms);
      EXPECT_EQ(odometry.rows.at(row).position, pose);
      EXPECT_EQ(odometry.rows.at(row).time, kBagStart + i * 10ms + 2ms);
      EXPECT_EQ(targets.rows.at(row).position, (testing::Values{a, b}));
      EXPECT_EQ(targets.rows.at(row).time, kBagStart + i * 10ms + 6ms) << "the log time";
    }
  }
}

TEST_F(Rosbag, ATopicIsReplayedToTheValuesThatWerePutIn) {
  add_interleaved();
  write("zstd");
  const testing::TestStream stream;
  const Ended replayed = testing::run({"replay", path(), "--topic", "/joint_states", "--joints",
                                       "b,a", "--stream", stream.name(), "--clock", "recorded",
                                       "--rate", "max", "--embedded", "--verify"});
  ASSERT_EQ(replayed.code, 0) << replayed.err;
  std::string times = "t_ns\n";
  std::vector<CopiedRow> rows;
  for (int i = 0; i < kRows; ++i) {
    rows.push_back({.time = kBagStart + i * 10ms, .position = {at(i, 1), at(i, 0)}});
    times += fmt::format("{}\n", rows.back().time.count());
  }
  const testing::TestFolder folder;
  const Ended samples =
      testing::run({"sample", stream.name(), "--at", folder.write("times.csv", times)});
  ASSERT_EQ(samples.code, 0) << samples.err;
  testing::expect_sampled(samples.out, rows);
}

TEST_F(Rosbag, ATrajectoryGivesItsPoints) {
  add("/plan", "trajectory_msgs/msg/JointTrajectory", kBagStart,
      joint_trajectory(kBagStart, {"a", "b"},
                       {{0s, {0, 1}, {2, 3}, {4, 5}}, {1s, {6, 7}}, {2s, {8, 9}}}));
  add("/plan", "trajectory_msgs/msg/JointTrajectory", kBagStart + 1s,
      joint_trajectory(kBagStart + 1500ms, {"b", "a"}, {{1s, {10, 11}, {12, 13}}},
                       std::endian::big));
  write("lz4");
  EXPECT_EQ(rows_of(path()).rows,
            (std::vector<CopiedRow>{{1, kBagStart, {0, 1}, {2, 3}, {4, 5}},
                                    {1, kBagStart + 1s, {6, 7}, {}, {}},
                                    {2, kBagStart + 2500ms, {11, 10}, {13, 12}, {}}}));
}

}  // namespace
}  // namespace splinecast::apps
