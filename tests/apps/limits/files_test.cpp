#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "apps/limits/file.hpp"
#include "apps/process/exit_codes.hpp"
#include "core/limits/named.hpp"
#include "tests/fixtures/processes/process.hpp"

namespace splinecast::apps {
namespace {

using testing::Ended;
using testing::Process;
using testing::run;
using testing::TestFolder;
using testing::TestStream;

constexpr const char* kRobot = R"(<?xml version="1.0"?>
<robot name="arm">
  <link name="a"/><link name="b"/><link name="c"/><link name="d"/><link name="e"/>
  <joint name="shoulder" type="revolute">
    <parent link="a"/><child link="b"/>
    <limit lower="-1" upper="2" effort="1" velocity="3"/>
  </joint>
  <joint name="roll" type="continuous"><parent link="b"/><child link="c"/>
    <limit effort="1" velocity="4"/></joint>
  <joint name="weld" type="fixed"><parent link="c"/><child link="d"/></joint>
  <joint name="finger" type="prismatic"><parent link="d"/><child link="e"/>
    <mimic joint="shoulder"/><limit lower="0" upper="1" effort="1" velocity="1"/></joint>
</robot>
)";

constexpr const char* kMoveIt = R"(default_velocity_scaling_factor: 0.5
default_acceleration_scaling_factor: 0.1
joint_limits:
  shoulder:
    has_velocity_limits: true
    max_velocity: 2
    has_acceleration_limits: true
    max_acceleration: 30
    has_jerk_limits: true
    max_jerk: 700
    min_position: -1
    max_position: 2.5
    max_effort: 80
  roll:
    has_velocity_limits: true
    max_velocity: 4
    has_acceleration_limits: false
    max_acceleration: 0
)";

/// Reads limit files. A test is skipped if this build cannot read files of its kind.
class LimitFiles : public ::testing::Test {
 protected:
  LimitFile read(const std::string& name, const std::string& text) {
    return read_limit_file(folder_.write(name, text));
  }

  std::string refusal(const std::string& name, const std::string& text) {
    try {
      (void)read(name, text);
    } catch (const InputError& error) {
      return error.what();
    }
    return {};
  }

  bool can_read(const std::string& name, const std::string& text) {
    return refusal(name, text).find("this build cannot read") == std::string::npos;
  }

  TestFolder folder_;
};

std::string with(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

TEST_F(LimitFiles, AJointLimitsFileGivesScaledVelocityAndAccelerationJerkAndBounds) {
  if (!can_read("joint_limits.yaml", kMoveIt)) GTEST_SKIP() << "built without yaml-cpp";
  const LimitFile file = read("joint_limits.yaml", kMoveIt);
  ASSERT_EQ(file.joints.size(), 2U);
  EXPECT_TRUE(file.notes.empty());
  const NamedLimits& shoulder = file.joints[0];
  EXPECT_EQ(shoulder.name, "shoulder");
  EXPECT_EQ(shoulder.velocity, 1);
  EXPECT_EQ(shoulder.acceleration, 3);
  EXPECT_EQ(shoulder.jerk, 700);
  EXPECT_EQ(shoulder.lower, -1);
  EXPECT_EQ(shoulder.upper, 2.5);
  EXPECT_EQ(file.joints[1].velocity, 2);
  EXPECT_EQ(file.joints[1].acceleration, 0);
  EXPECT_TRUE(std::isinf(file.joints[1].upper));
}

TEST_F(LimitFiles, UnknownKeysOfAJointLimitsFileAreReportedWithTheirLine) {
  if (!can_read("joint_limits.yaml", kMoveIt)) GTEST_SKIP() << "built without yaml-cpp";
  std::string text = with(kMoveIt, "max_effort", "max_speed");
  text += "  scaling: 3\nplanner: none\n";
  const LimitFile file = read("joint_limits.yaml", text);
  ASSERT_EQ(file.notes.size(), 3U);
  EXPECT_NE(file.notes[0].find("joint_limits.yaml:20: unknown key 'planner'"), std::string::npos)
      << file.notes[0];
  EXPECT_NE(file.notes[1].find(":13: unknown key 'max_speed' of joint 'shoulder'"),
            std::string::npos);
  EXPECT_NE(file.notes[2].find(":19: 'scaling'"), std::string::npos);
}

TEST_F(LimitFiles, BadValuesOfAJointLimitsFileAreRefusedWithLineAndValue) {
  if (!can_read("joint_limits.yaml", kMoveIt)) GTEST_SKIP() << "built without yaml-cpp";
  const std::vector<std::pair<std::string, std::string>> cases{
      {with(kMoveIt, "max_velocity: 2", "max_velocity: two"), ":6: max_velocity: 'two'"},
      {with(kMoveIt, "max_velocity: 2", "max_velocity: -2"), ":6: max_velocity: -2"},
      {with(kMoveIt, "max_velocity: 2", "max_velocity: .nan"), ":6: max_velocity: '.nan'"},
      {with(kMoveIt, "    max_velocity: 2\n", ""), ":5: there is no max_velocity"},
      {with(kMoveIt, "factor: 0.5", "factor: 1.5"), ":1: default_velocity_scaling_factor: 1.5"},
      {with(kMoveIt, "min_position: -1", "min_position: 3"), ":11: min_position 3 is not below"},
      {with(kMoveIt, "limits: true", "limits: maybe"), ":5: has_velocity_limits is neither"},
      {with(kMoveIt, "  roll:", "  shoulder:"), ":14: joint 'shoulder' occurs twice"},
      {"joint_limits:\n  a: [1, {\n", "joint_limits.yaml:"},
      {"a: 1\n", "there is no map 'joint_limits'"},
      {"joint_limits: 3\n", ":1: 'joint_limits' is not a map"},
      {"", "is empty"},
  };
  for (const auto& [text, message] : cases) {
    const std::string why = refusal("joint_limits.yaml", text);
    EXPECT_NE(why.find(message), std::string::npos) << message << " is not in: " << why;
  }
}

TEST_F(LimitFiles, AUrdfFileGivesVelocityLimitsAndBoundsOfItsMovingJoints) {
  if (!can_read("arm.urdf", kRobot)) GTEST_SKIP() << "built without urdfdom";
  const LimitFile file = read("arm.urdf", kRobot);
  ASSERT_EQ(file.joints.size(), 2U);
  EXPECT_EQ(file.joints[0].name, "shoulder");
  EXPECT_EQ(file.joints[0].velocity, 3);
  EXPECT_EQ(file.joints[0].lower, -1);
  EXPECT_EQ(file.joints[0].upper, 2);
  EXPECT_EQ(file.joints[1].name, "roll");
  EXPECT_EQ(file.joints[1].velocity, 4);
  EXPECT_TRUE(std::isinf(file.joints[1].lower));
  const LimitFile unset = read("arm.urdf", with(kRobot, "velocity=\"3\"", "velocity=\"0\""));
  EXPECT_EQ(unset.joints[0].velocity, 0);
  ASSERT_EQ(unset.notes.size(), 1U);
  EXPECT_NE(unset.notes[0].find("arm.urdf:4: velocity 0"), std::string::npos) << unset.notes[0];
}

TEST_F(LimitFiles, BadUrdfFilesAreRefusedWithLineAndValue) {
  if (!can_read("arm.urdf", kRobot)) GTEST_SKIP() << "built without urdfdom";
  std::string deep = "<robot name=\"r\">";
  std::string disguised = deep;
  for (int i = 0; i < 100'000; ++i) deep += "<a>";
  for (int i = 0; i < 100'000; ++i) disguised += "<a b='/>' >/><!-- /> --><!x '><?y '>";
  std::string flat = deep.substr(0, 16);
  for (int i = 0; i < 1'000; ++i) flat += "<!-- <a> --><a b='>'/><a></a>";
  const std::vector<std::pair<std::string, std::string>> cases{
      {with(kRobot, "velocity=\"3\"", "velocity=\"3x\""), "arm.urdf:4: velocity value (3x)"},
      {with(kRobot, "velocity=\"3\"", "velocity=\"-3\""), "arm.urdf:4: velocity -3"},
      {with(kRobot, "lower=\"-1\"", "lower=\"2\""), "arm.urdf:4: lower 2 of joint 'shoulder'"},
      {with(kRobot, "</joint>", "</joynt>"), "arm.urdf:7:"},
      {"<sdf/>", "no element 'robot'"},
      {"<", "arm.urdf:"},
      {deep, "arm.urdf:1: elements are nested more than 200 deep"},
      {disguised, "arm.urdf:1: elements are nested more than 200 deep"},
      {flat, "arm.urdf:1: Error"},
  };
  for (const auto& [text, message] : cases) {
    const std::string why = refusal("arm.urdf", text);
    EXPECT_NE(why.find(message), std::string::npos) << message << " is not in: " << why;
  }
}

TEST(NamedLimits, ApplyToTheDimensionOfTheirNameWithOrWithoutItsUnit) {
  const std::vector<NamedLimits> joints{{.name = "q1", .velocity = 1, .upper = 3},
                                        {.name = "q3", .velocity = 2}};
  const std::vector<std::string> names{"q1 [rad]", "q2"};
  const MotionLimits limits = core::matched(joints, names);
  EXPECT_EQ(limits.velocity, (std::vector<double>{1, 0}));
  EXPECT_TRUE(limits.lower.empty());
  EXPECT_EQ(limits.upper[0], 3);
  EXPECT_EQ(core::unmatched(joints, names), std::vector<std::string>{"q3"});
  EXPECT_EQ(core::without_limits(limits, std::vector<Dimension>(2)), std::vector<std::size_t>{1});
  const std::vector<NamedLimits> twice{{.name = "q1"}, {.name = "q1 [rad]"}};
  EXPECT_THROW((void)core::matched(twice, names), std::invalid_argument);
}

TEST_F(LimitFiles, SolveStoresLimitsInTheStreamAndInfoShowsThem) {
  if (!can_read("arm.urdf", kRobot)) GTEST_SKIP() << "built without urdfdom";
  const TestStream stream;
  const auto limits = folder_.write("arm.urdf", kRobot);
  const auto moves = folder_.write("a.csv", "t,shoulder,wrist\n0,0,0\n1,0.1,1\n2,0,0\n");
  Process solver({"solve", stream.name(), "--limits", limits, "--max-jerk", "none,5e3"});
  const Ended sent = run({"replay", moves, "--stream", stream.name(), "--clock", "recorded"});
  ASSERT_EQ(sent.code, 0) << sent.err;
  const auto shown = testing::info(stream.name())["solver"]["limits"];
  EXPECT_EQ(shown["velocity"], nlohmann::json({3.0, nullptr}));
  EXPECT_EQ(shown["acceleration"], nlohmann::json::array());
  EXPECT_EQ(shown["jerk"], nlohmann::json({nullptr, 5e3}));
  EXPECT_EQ(shown["lower"], nlohmann::json({-1.0, nullptr}));
  EXPECT_EQ(shown["upper"], nlohmann::json({2.0, nullptr}));
  EXPECT_EQ(shown["beyond"], "report");
  solver.signal(SIGTERM);
  const Ended ended = solver.wait();
  EXPECT_NE(ended.err.find("these limits match no dimension: 'roll'"), std::string::npos)
      << ended.err;
  const std::vector<std::pair<std::vector<std::string>, std::string>> cases{
      {{"--max-velocity", "2"}, "velocity limit"},
      {{"--bounds", "-1:1"}, "lower bound none, not -1"}};
  for (const auto& [arguments, message] : cases) {
    std::vector<std::string> solve{"solve", stream.name()};
    solve.insert(solve.end(), arguments.begin(), arguments.end());
    const Ended refused = run(solve);
    EXPECT_EQ(refused.code, 2) << message;
    EXPECT_NE(refused.err.find(message), std::string::npos) << refused.err;
  }
  const Process agreeing({"solve", stream.name(), "--limits", limits});
}

/// 40 rows of a slow motion; one row is far off.
std::string slow_rows_but_one() {
  std::string rows = "t,shoulder,wrist\n";
  for (int i = 0; i < 40; ++i) {
    rows += std::to_string(i) + "," + std::to_string(0.01 * i) + "," +
            (i == 20 ? "5" : std::to_string(0.02 * i)) + "\n";
  }
  return rows;
}

TEST_F(LimitFiles, SolveReportsOrRefusesWaypointsBeyondThemWithTheirPlace) {
  const auto moves = folder_.write("steps.csv", slow_rows_but_one());
  for (const std::string beyond : {"report", "refuse"}) {
    const TestStream stream;
    Process solver({"solve", stream.name(), "--max-acceleration", "0.2", "--beyond", beyond});
    const Ended sent = run({"replay", moves, "--stream", stream.name(), "--clock", "recorded",
                            "--rate", "max", "--on-error", "skip", "--json"});
    ASSERT_EQ(sent.code, 0) << sent.err;
    const auto report = nlohmann::json::parse(sent.out);
    const auto shown = testing::info(stream.name())["solver"];
    EXPECT_EQ(shown["limits"]["beyond"], beyond);
    ASSERT_GE(shown["excesses"].size(), 1U);
    const auto& first = shown["excesses"][0];
    EXPECT_EQ(shown["exceeding"], shown["excesses"].size());
    EXPECT_EQ(first["item"], 20);
    EXPECT_EQ(first["refused"], beyond == "refuse");
    EXPECT_EQ(first["kind"], "acceleration");
    EXPECT_EQ(first["dimension"], 1);
    EXPECT_EQ(first["limit"], 0.2);
    EXPECT_GT(std::abs(first["value"].get<double>()), 0.2);
    solver.signal(SIGTERM);
    const Ended ended = solver.wait();
    const std::string place = "acceleration of dimension 1 (wrist) is ";
    if (beyond == "refuse") {
      EXPECT_EQ(report["refused_by_reason"]["beyond limits"], 1);
      EXPECT_EQ(report["interpolated"], 39);
      EXPECT_EQ(report["rows"][0]["beyond"]["value"], first["value"]);
      EXPECT_NE(sent.err.find("steps.csv:22: waypoint refused by the solver: beyond limits (item "
                              "20): " +
                              place),
                std::string::npos)
          << sent.err;
    } else {
      EXPECT_EQ(report["refused"], 0);
      EXPECT_NE(ended.err.find("limit exceeded, item 20, " + place), std::string::npos)
          << ended.err;
    }
  }
  EXPECT_EQ(run({"solve", "x", "--beyond", "slow"}).code, 2);
}

}  // namespace
}  // namespace splinecast::apps
