#include "apps/messages/ros.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "apps/messages/message_error.hpp"
#include "tests/fixtures/messages/cdr_writer.hpp"

/// Messages of ROS 2 in CDR.
namespace splinecast::apps::ros {
namespace {

using namespace std::chrono_literals;
using testing::CdrWriter;

constexpr Time kStamp = 1'700'000'000s + 123'456'789ns;

class Ros : public ::testing::TestWithParam<std::endian> {
 protected:
  void SetUp() override {
    if (!can_decode()) GTEST_SKIP() << "built without libfastcdr";
  }
};

TEST_P(Ros, DecodesAJointState) {
  JointState state;
  const auto bytes = testing::joint_state(kStamp, {"a", "elbow_joint", ""}, {1.5, -2, 1e-300},
                                          {0.25, 0, -7}, GetParam());
  decode(bytes, state);
  EXPECT_EQ(state.stamp, kStamp);
  EXPECT_EQ(state.names, (std::vector<std::string_view>{"a", "elbow_joint", ""}));
  EXPECT_EQ(state.positions, (std::vector<double>{1.5, -2, 1e-300}));
  EXPECT_EQ(state.velocities, (std::vector<double>{0.25, 0, -7}));
  const auto shorter = testing::joint_state(-1s, {"b"}, {3}, {}, GetParam());
  decode(shorter, state);
  EXPECT_EQ(state.stamp, -1s);
  EXPECT_EQ(state.positions, (std::vector<double>{3}));
  EXPECT_TRUE(state.velocities.empty());
}

TEST_P(Ros, DecodesAJointTrajectory) {
  JointTrajectory trajectory;
  const auto bytes = testing::joint_trajectory(
      kStamp, {"a", "b"}, {{0s, {1, 2}, {3, 4}, {5, 6}}, {1500ms, {7, 8}}}, GetParam());
  decode(bytes, trajectory);
  EXPECT_EQ(trajectory.stamp, kStamp);
  EXPECT_EQ(trajectory.names, (std::vector<std::string_view>{"a", "b"}));
  ASSERT_EQ(trajectory.points.size(), 2U);
  EXPECT_EQ(trajectory.points[0].positions, (std::vector<double>{1, 2}));
  EXPECT_EQ(trajectory.points[0].velocities, (std::vector<double>{3, 4}));
  EXPECT_EQ(trajectory.points[0].accelerations, (std::vector<double>{5, 6}));
  EXPECT_EQ(trajectory.points[1].from_start, 1500ms);
  EXPECT_EQ(trajectory.points[1].positions, (std::vector<double>{7, 8}));
  EXPECT_TRUE(trajectory.points[1].velocities.empty());
}

TEST_P(Ros, DecodesThePosesOfAPoseStampedAndOfAnOdometry) {
  const std::vector<double> values{1, 2, 3, 0.5, 0.5, -0.5, 0.5};
  Pose pose;
  decode_pose_stamped(testing::pose_stamped(kStamp, values, GetParam()), pose);
  EXPECT_EQ(pose.stamp, kStamp);
  EXPECT_TRUE(std::ranges::equal(pose.values, values));
  pose = {};
  decode_odometry(testing::odometry(kStamp, values, GetParam()), pose);
  EXPECT_EQ(pose.stamp, kStamp);
  EXPECT_TRUE(std::ranges::equal(pose.values, values));
}

TEST_P(Ros, RefusesEveryMessageThatIsCutOff) {
  const auto state = testing::joint_state(kStamp, {"a", "b"}, {1, 2}, {3, 4}, GetParam());
  const std::size_t effort = 4;  // the empty sequence at the end, which is not read
  for (std::size_t size = 0; size + effort < state.size(); ++size) {
    JointState decoded;
    EXPECT_THROW(decode(Bytes(state).first(size), decoded), MessageError) << size;
  }
  const auto trajectory =
      testing::joint_trajectory(kStamp, {"a"}, {{0s, {1}, {2}}, {1s, {3}}}, GetParam());
  for (std::size_t size = 0; size < trajectory.size(); ++size) {
    JointTrajectory decoded;
    EXPECT_THROW(decode(Bytes(trajectory).first(size), decoded), MessageError) << size;
  }
}

std::string error_of(const std::vector<std::byte>& message) {
  try {
    JointState state;
    decode(message, state);
  } catch (const MessageError& error) {
    return error.what();
  }
  return "none";
}

TEST_P(Ros, ChecksEachLengthBeforeItReservesMemory) {
  CdrWriter names(GetParam());
  names.header(kStamp, "").number(0xFFFFFFFFU);
  EXPECT_EQ(error_of(names.bytes()),
            "byte 24: a sequence is longer than the rest of the message; its length: 4294967295");
  CdrWriter frame(GetParam());
  frame.time(kStamp).number(0x7FFFFFFFU);
  EXPECT_EQ(error_of(frame.bytes()),
            "byte 16: a string is longer than the rest of the message; its length: 2147483647");
  CdrWriter values(GetParam());
  values.header(kStamp, "").number(1U).text("a").number(0x20000000U);
  EXPECT_NE(error_of(values.bytes()).find("its length: 536870912"), std::string::npos);
}

TEST_P(Ros, RefusesValuesThatDoNotBelongToTheNames) {
  EXPECT_NE(error_of(testing::joint_state(kStamp, {"a", "b"}, {1}, {}, GetParam()))
                .find("the number of values is not that of the joints: 1"),
            std::string::npos);
  CdrWriter stamp(GetParam());
  stamp.number(0).number(1'000'000'000U).text("");
  EXPECT_NE(error_of(stamp.bytes()).find("nanoseconds"), std::string::npos);
}

INSTANTIATE_TEST_SUITE_P(Orders, Ros, ::testing::Values(std::endian::little, std::endian::big),
                         [](const auto& order) {
                           return order.param == std::endian::little ? "LittleEndian" : "BigEndian";
                         });

TEST(RosEncapsulation, IsRefusedIfItIsNotPlainCdr) {
  if (!can_decode()) GTEST_SKIP() << "built without libfastcdr";
  auto message = testing::joint_state(kStamp, {"a"}, {1}, {});
  message[1] = std::byte{3};
  EXPECT_EQ(error_of(message), "byte 0: the encapsulation is not that of plain CDR (0 or 1): 3");
  message[0] = std::byte{1};
  EXPECT_NE(error_of(message).find(": 259"), std::string::npos);
}

}  // namespace
}  // namespace splinecast::apps::ros
