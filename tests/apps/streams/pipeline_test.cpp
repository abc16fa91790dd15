#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <memory>
#include <string>
#include <vector>

#include "tests/fixtures/curves/mesh.hpp"
#include "tests/fixtures/curves/polynomial_trajectory.hpp"
#include "tests/fixtures/curves/recordings.hpp"
#include "tests/fixtures/processes/process.hpp"
#include "tests/fixtures/processes/shared_files.hpp"

/// Recorded streams through three processes: the samples from shared memory equal the output of
/// `fit --online`, bit for bit.
namespace splinecast::apps {
namespace {

using testing::Ended;
using testing::Process;
using testing::run;
using testing::TestFolder;
using testing::TestStream;

struct Shape {
  std::string settle;
  std::string tail;
  std::string start;
  std::string end;
};

const std::vector<Shape>& shapes() {
  static const std::vector<Shape> all{{"8", "bessel", "natural", "halt"},
                                      {"0", "parabolic", "halt", "natural"},
                                      {"1", "clamped", "clamped", "clamped"},
                                      {"64", "natural", "natural", "natural"}};
  return all;
}

/// Sends a file through solve, replay and sample and expects the bits of fit --online.
void expect_same_bits(const std::string& file, const std::vector<std::string>& columns,
                      const std::string& at, const Shape& shape) {
  const TestStream stream;
  Process solver({"solve", stream.name(), "--settle", shape.settle, "--tail", shape.tail,
                  "--capacity", "8192"});
  std::vector<std::string> replay{"replay", file,      "--stream", stream.name(), "--rate",
                                  "max",    "--clock", "recorded", "--start",     shape.start,
                                  "--end",  shape.end, "--gap",    "bridge"};
  std::vector<std::string> fit{"fit",       file,         "--gap",   "bridge",   "--online",
                               "--settle",  shape.settle, "--tail",  shape.tail, "--start",
                               shape.start, "--end",      shape.end, "--at",     at};
  replay.insert(replay.end(), columns.begin(), columns.end());
  fit.insert(fit.end(), columns.begin(), columns.end());
  const Ended sent = run(replay);
  ASSERT_EQ(sent.code, 0) << sent.err;
  const Ended sampled = run({"sample", stream.name(), "--at", at});
  ASSERT_EQ(sampled.code, 0) << sampled.err;
  const Ended fitted = run(fit);
  ASSERT_EQ(fitted.code, 0) << fitted.err;
  EXPECT_TRUE(testing::same_text(testing::without_status(sampled.out), fitted.out));
  EXPECT_EQ(testing::count_status(sampled.out, "settled") + 1,
            static_cast<std::size_t>(std::ranges::count(fitted.out, '\n')));
  solver.signal(SIGTERM);
  EXPECT_EQ(solver.wait().code, 0);
}

/// Writes times every `dt` seconds over a recording, with `fit`. Returns the path.
std::string times_within(const TestFolder& folder, const std::string& file,
                         const std::vector<std::string>& columns, const std::string& dt) {
  std::vector<std::string> fit{"fit", file, "--dt", dt, "-o", folder.path("at.csv")};
  fit.insert(fit.end(), columns.begin(), columns.end());
  EXPECT_EQ(run(fit).code, 0);
  return folder.path("at.csv");
}

TEST(Pipeline, ARandomRecordingComesThroughBitForBit) {
  const TestFolder folder;
  const auto mesh = testing::random_mesh(1, 3000, 3, 5);
  const auto file = folder.write("a.csv", testing::to_csv(mesh));
  const auto at = folder.write("at.csv", testing::times_csv(mesh, 3));
  for (const Shape& shape : shapes()) expect_same_bits(file, {}, at, shape);
}

TEST(Pipeline, ADronesPositionLogComesThroughBitForBit) {
  const auto file = testing::shared_file("data/px4_drone_log/vehicle_local_position.csv");
  REQUIRE_SHARED_FILE(file);
  const TestFolder folder;
  const std::vector<std::string> columns{"--columns", "x,y,z"};
  const auto at = times_within(folder, file, columns, "0.0013");
  for (const Shape& shape : shapes()) expect_same_bits(file, columns, at, shape);
}

TEST(Pipeline, ACamerasGroundTruthComesThroughBitForBit) {
  const auto file = testing::shared_file("data/tum_rgbd_pose/freiburg1_xyz-groundtruth.txt");
  REQUIRE_SHARED_FILE(file);
  const TestFolder folder;
  const std::vector<std::string> columns{"--columns", "x,y,z"};
  const auto at = times_within(folder, file, columns, "0.0031");
  for (const Shape& shape : shapes()) expect_same_bits(file, columns, at, shape);
}

TEST(Pipeline, QuadrotorPolynomialsAt100HzComeThroughBitForBit) {
  for (const char* name :
       {"figure8.csv", "traj0.csv", "figure8_ideal_traj.csv", "multi_trajectory_ideal_traj0.csv"}) {
    const auto path = testing::shared_file(std::string("data/crazyswarm2_poly/") + name);
    REQUIRE_SHARED_FILE(path);
    const TestFolder folder;
    const auto mesh = testing::PolynomialTrajectory(path).sampled(Time(10'000'000));
    const auto file = folder.write("a.csv", testing::to_csv(mesh));
    const auto at = folder.write("at.csv", testing::times_csv(mesh, 2));
    for (const Shape& shape : shapes()) expect_same_bits(file, {}, at, shape);
  }
}

TEST(Pipeline, AnEmbeddedSolverGivesTheSameBits) {
  const TestFolder folder;
  const TestStream stream;
  const auto mesh = testing::random_mesh(2, 2500, 2, 5);
  const auto file = folder.write("a.csv", testing::to_csv(mesh));
  const auto at = folder.write("at.csv", testing::times_csv(mesh, 2));
  const Ended sent = run({"replay", file, "--stream", stream.name(), "--rate", "max", "--clock",
                          "recorded", "--embedded", "--settle", "5", "--gap", "bridge"});
  ASSERT_EQ(sent.code, 0) << sent.err;
  EXPECT_TRUE(testing::same_text(
      testing::without_status(run({"sample", stream.name(), "--at", at}).out),
      run({"fit", file, "--online", "--settle", "5", "--gap", "bridge", "--at", at}).out));
}

TEST(Pipeline, ASolverKilledInTheMiddleIsTakenOverBitForBit) {
  const TestFolder folder;
  const TestStream stream;
  auto mesh = testing::random_mesh(3, 3000, 2, 5);
  // Paced, about 2 s long, so that every solver is killed in the middle of the stream.
  const double scale = 2e9 / static_cast<double>(mesh.times.back().count());
  for (Time& t : mesh.times) {
    t = Time(std::llround(static_cast<double>(t.count()) * scale));
  }
  for (std::size_t i = 1; i < mesh.size(); ++i) {
    mesh.times[i] = std::max(mesh.times[i], mesh.times[i - 1] + Time(1000));
  }
  const auto file = folder.write("a.csv", testing::to_csv(mesh));
  const auto at = folder.write("at.csv", testing::times_csv(mesh, 2));
  auto solver = std::make_unique<Process>(std::vector<std::string>{"solve", stream.name()});
  Process replay({"replay", file, "--stream", stream.name(), "--clock", "recorded"});
  for (int kills = 1; kills <= 4; ++kills) {
    ASSERT_TRUE(testing::await([&] {
      const auto now = testing::info(stream.name());
      return now.contains("solver") && now["solver"].is_object() &&
             now["solver"]["epoch"] == kills && now["solver"]["interpolated"] > 400 * kills;
    }));
    solver->signal(SIGKILL);
    ASSERT_EQ(solver->wait().signal, SIGKILL);
    solver = std::make_unique<Process>(std::vector<std::string>{"solve", stream.name()});
  }
  const Ended sent = replay.wait();
  ASSERT_EQ(sent.code, 0) << sent.err;
  EXPECT_NE(sent.err.find("3000 waypoints sent, 3000 interpolated, 0 refused"), std::string::npos)
      << sent.err;
  EXPECT_TRUE(
      testing::same_text(testing::without_status(run({"sample", stream.name(), "--at", at}).out),
                         run({"fit", file, "--online", "--at", at}).out));
  EXPECT_EQ(testing::info(stream.name())["solver"]["epoch"], 5);
}

}  // namespace
}  // namespace splinecast::apps
