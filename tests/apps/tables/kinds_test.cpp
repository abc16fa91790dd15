#include "apps/tables/kinds.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <csignal>
#include <map>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "splinecast/calculus.hpp"
#include "tests/fixtures/curves/recordings.hpp"
#include "tests/fixtures/curves/rotation.hpp"
#include "tests/fixtures/processes/process.hpp"
#include "tests/fixtures/processes/shared_files.hpp"

/// Files with periodic columns or quaternions: their kinds, and the samples of their streams.
namespace splinecast::apps {
namespace {

using testing::Ended;
using testing::Process;
using testing::run;
using testing::TestFolder;
using testing::TestStream;

using Names = std::vector<std::string>;

/// The kinds of columns with these names, as text: `linear quaternion …`.
std::string kinds_of(const Names& names, const Names& asked = {}, const Names& aliases = {}) {
  std::vector<KindOption> options;
  for (const std::string& text : asked) options.push_back(parse_kind_option(text).value());
  std::string text;
  try {
    for (const Dimension& kind : resolve_kinds("f.csv", {names, aliases, {}}, options)) {
      if (!text.empty()) text += " ";
      text += to_string(kind);
    }
  } catch (const InputError& error) {
    return error.what();
  }
  return text;
}

TEST(Kinds, ColumnsNamedAsAnOrientationAreAQuaternion) {
  const std::string last = "linear quaternion quaternion quaternion quaternion";
  EXPECT_EQ(kinds_of({"x", "qx", "qy", "qz", "qw"}), last);
  const std::string first =
      "linear quaternion-wxyz quaternion-wxyz quaternion-wxyz quaternion-wxyz";
  EXPECT_EQ(kinds_of({"x", "qw", "qx", "qy", "qz"}), first);
  EXPECT_EQ(kinds_of({"p_RS_R_z [m]", "q_RS_w []", "q_RS_x []", "q_RS_y []", "q_RS_z []"}), first);
  EXPECT_EQ(kinds_of({"x", "q_x", "q_y", "q_z", "q_w"}), last);
  for (const Names& none :
       {Names{"qx", "qy", "qz"}, Names{"qx", "qy", "qw", "qz"}, Names{"x", "y", "z", "w"},
        Names{"q_A_x", "q_A_y", "q_B_z", "q_B_w"}, Names{"q1", "q2", "q3", "q4"}}) {
    EXPECT_EQ(kinds_of(none).find("quaternion"), std::string::npos) << none.front();
  }
}

TEST(Kinds, OptionsTakePrecedenceOverNames) {
  EXPECT_EQ(kinds_of({"a", "qx", "qy", "qz", "qw"}, {"qz:linear"}),
            "linear linear linear linear linear");
  EXPECT_EQ(kinds_of({"a", "b"}, {"1:periodic:360"}), "linear periodic:360");
  EXPECT_EQ(kinds_of({"tx", "ty"}, {"y:periodic:2"}, {"x", "y"}), "linear periodic:2");
  EXPECT_EQ(kinds_of({"yaw [deg]", "b"}, {"yaw:periodic:360"}), "periodic:360 linear");
  EXPECT_EQ(kinds_of({"1", "0"}, {"0:periodic:2"}), "linear periodic:2");
  EXPECT_EQ(kinds_of({"q[0]", "q[1]", "q[2]", "q[3]"}, {"q[0]:quaternion-wxyz"}),
            "quaternion-wxyz quaternion-wxyz quaternion-wxyz quaternion-wxyz");
  EXPECT_EQ(kinds_of({"o.w", "o.x", "o.y", "o.z"}, {"0:quaternion"}),
            "quaternion-wxyz quaternion-wxyz quaternion-wxyz quaternion-wxyz");
  EXPECT_EQ(kinds_of({"a:b", "c"}, {"a:b:periodic:3"}), "periodic:3 linear");
}

TEST(Kinds, InvalidKindsAreRefusedWithTheirDimension) {
  EXPECT_EQ(kinds_of({"x", "y"}, {"9:periodic:360"}),
            "f.csv: --kind 9:periodic:360: there is no dimension '9' among 0 to 1 (x, y)");
  EXPECT_EQ(
      kinds_of({"x", "y"}, {"y:quaternion"}),
      "f.csv: --kind y:quaternion: a quaternion has four dimensions; from 'y' on there are 1");
  EXPECT_EQ(kinds_of({"x", "y"}, {"y:periodic:1", "1:periodic:2"}),
            "f.csv: --kind 1:periodic:2: dimension 'y' is given two kinds");
  for (const char* text :
       {"", ":", "x", "x:", "x:wrap", "x:periodic:", "x:periodic:0", ":linear"}) {
    EXPECT_FALSE(parse_kind_option(text).has_value()) << text;
  }
}

TEST(Kinds, WrongKindsAreWrongUsage) {
  const TestFolder folder;
  const auto file = folder.write("a.csv", "t,x,qx,qy,qz,qw\n0,1,0,0,0,1\n1,2,0,0,0,0\n");
  const TestStream stream;
  const std::vector<std::pair<std::vector<std::string>, std::string>> cases{
      {{"--kind", "9:periodic:360"}, "--kind 9:periodic:360: there is no dimension '9'"},
      {{"--kind", "x:periodic:0"}, "'x:periodic:0' is not one of I:linear"},
      {{"--kind", "qy:quaternion"}, "four dimensions; from 'qy' on there are 3"},
      {{}, "a.csv:3: waypoint refused: columns 'qx' to 'qw': a quaternion of length 0"},
      {{"--clock", "recorded", "--on-error", "skip", "--end", "velocity=1,0,2,0,0"},
       "has 2 in dimension 2"}};
  for (const auto& [arguments, message] : cases) {
    std::vector<std::string> replay{"replay", file, "--stream", stream.name(), "--embedded"};
    replay.insert(replay.end(), arguments.begin(), arguments.end());
    const Ended ended = run(replay);
    EXPECT_EQ(ended.code, 2) << message;
    EXPECT_NE(ended.err.find(message), std::string::npos) << ended.err;
  }
  const Ended fitted = run({"fit", file, "--dt", "1"});
  EXPECT_EQ(fitted.code, 2);
  EXPECT_NE(fitted.err.find("a.csv:3: columns 'qx' to 'qw'"), std::string::npos) << fitted.err;
  EXPECT_EQ(run({"fit", file, "--dt", "1", "--kind", "qx:linear"}).code, 0);
}

/// The columns of a CSV by name.
std::map<std::string, std::vector<double>> columns_of(const std::string& csv) {
  std::istringstream lines(csv);
  std::string line;
  std::getline(lines, line);
  const auto fields = [](const std::string& text) {
    Names all;
    std::istringstream stream(text);
    for (std::string field; std::getline(stream, field, ',');) all.push_back(field);
    return all;
  };
  const Names names = fields(line);
  std::map<std::string, std::vector<double>> columns;
  while (std::getline(lines, line)) {
    const Names row = fields(line);
    for (std::size_t c = 0; c < names.size(); ++c) {
      if (names[c] != "status") columns[names[c]].push_back(std::stod(row.at(c)));
    }
  }
  return columns;
}

/// Sends a file through solve, replay and sample. The samples must have the bits of fit --online.
std::string through_a_stream(const std::string& file, const std::string& at,
                             const std::vector<std::string>& options, std::string& kinds) {
  const TestStream stream;
  Process solver({"solve", stream.name(), "--settle", "16"});
  std::vector<std::string> replay{"replay", file,  "--stream", stream.name(),
                                  "--rate", "max", "--clock",  "recorded"};
  std::vector<std::string> fit{"fit", file, "--online", "--settle", "16", "--at", at};
  replay.insert(replay.end(), options.begin(), options.end());
  fit.insert(fit.end(), options.begin(), options.end());
  const Ended sent = run(replay);
  EXPECT_EQ(sent.code, 0) << sent.err;
  const Ended sampled = run({"sample", stream.name(), "--at", at});
  EXPECT_EQ(sampled.code, 0) << sampled.err;
  EXPECT_TRUE(testing::same_text(testing::without_status(sampled.out), run(fit).out));
  kinds = testing::info(stream.name()).at("kinds").dump();
  solver.signal(SIGTERM);
  EXPECT_EQ(solver.wait().code, 0);
  return sampled.out;
}

/// Writes times every `step` from `first` to `last` into an `--at` file. Returns its path.
std::string times(const TestFolder& folder, std::int64_t first, std::int64_t last,
                  std::int64_t step) {
  std::string text = "t_ns\n";
  for (std::int64_t t = first; t <= last; t += step) text += fmt::format("{}\n", t);
  return folder.write("at.csv", text);
}

constexpr std::int64_t kPeriod = 10'000'000;  // ns
constexpr double kH = 0.01;
constexpr int kRows = 400;

/// A CSV of a coning rotation at 100 Hz with random signs and this header.
std::string coning_csv(const std::string& header, bool w_first) {
  const testing::Coning coning;
  std::mt19937_64 random(11);  // NOLINT(*-msc51-cpp): the same flips in every run
  std::string text = header + "\n";
  for (int i = 0; i < kRows; ++i) {
    const auto [x, y, z, w] = coning.quaternion(i * kH);
    const std::array<double, 4> q = w_first ? std::array{w, x, y, z} : std::array{x, y, z, w};
    text += fmt::format("{},{}", i * kPeriod, 0.1 * i);
    const double sign = random() % 2 == 0 ? -1 : 1;
    for (const double value : q) text += fmt::format(",{}", sign * value);
    text += "\n";
  }
  return text;
}

/// The largest errors of sampled ω and α.
std::array<double, 2> motion_errors(const std::map<std::string, std::vector<double>>& samples) {
  const testing::Coning coning;
  std::array<double, 2> most{};
  for (std::size_t i = 0; i < samples.at("t_ns").size(); ++i) {
    const auto wanted = coning.motion(samples.at("t_ns")[i] / 1e9);
    for (std::size_t k = 0; k < 3; ++k) {
      const auto of = [&](const char* word) {
        return samples.at(fmt::format("{}[{}]", word, k))[i];
      };
      most[0] = std::max(most[0], std::abs(of("omega") - wanted.velocity[k]));
      most[1] = std::max(most[1], std::abs(of("alpha") - wanted.acceleration[k]));
    }
  }
  return most;
}

void expect_motion_of_coning(const std::string& header, bool w_first, const std::string& kinds) {
  const TestFolder folder;
  const auto file = folder.write("a.csv", coning_csv(header, w_first));
  const auto at = times(folder, 30 * kPeriod, (kRows - 30) * kPeriod, 1'300'000);
  std::string kinds_seen;
  const auto samples = columns_of(through_a_stream(file, at, {}, kinds_seen));
  EXPECT_EQ(kinds_seen, kinds);
  // The bounds of tests/ipc/solve/dimension_kinds_test.cpp.
  const double m = testing::Coning().derivative_bound(4);
  const std::array<double, 2> bounds{1.1 * 2 * kH * kH * kH * m / 24, 1.1 * 6 * kH * kH * m / 8};
  const auto errors = motion_errors(samples);
  fmt::print(
      "largest error: omega {:.3g} rad/s (bound {:.3g}), alpha {:.3g} rad/s2 (bound {:.3g})\n",
      errors[0], bounds[0], errors[1], bounds[1]);
  EXPECT_LT(errors[0], bounds[0]);
  EXPECT_LT(errors[1], bounds[1]);
  // No jump at a change of sign: each component changes by at most its speed times 1.3 ms.
  for (const char* name : {"p[1]", "p[2]", "p[3]", "p[4]"}) {
    const std::vector<double>& p = samples.at(name);
    for (std::size_t i = 1; i < p.size(); ++i) {
      ASSERT_LT(std::abs(p[i] - p[i - 1]), 1.31e-3 * testing::Coning().derivative_bound(1));
    }
  }
}

TEST(KindsPipeline, AQuaternionStreamHasTheAngularMotionOfItsRotation) {
  expect_motion_of_coning("t_ns,x,qx,qy,qz,qw", false,
                          R"(["linear","quaternion","quaternion","quaternion","quaternion"])");
}

TEST(KindsPipeline, AEurocFileWithWFirstHasTheAngularMotionOfItsRotation) {
  expect_motion_of_coning(
      "#timestamp [ns],p_RS_R_x [m],q_RS_w [],q_RS_x [],q_RS_y [],q_RS_z []", true,
      R"(["linear","quaternion-wxyz","quaternion-wxyz","quaternion-wxyz","quaternion-wxyz"])");
}

TEST(KindsPipeline, AHeadingWrapsWithoutAJump) {
  const TestFolder folder;
  // Oscillates with up to 300 degrees per second and crosses ±180 degrees several times.
  const auto heading = [](double t) { return 170 + 250 * std::sin(1.2 * t); };
  std::string text = "t_ns,heading [deg],x\n";
  for (int i = 0; i < 1500; ++i) {
    text += fmt::format("{},{},{}\n", i * kPeriod, std::remainder(heading(i * kH), 360.0), i);
  }
  const auto file = folder.write("a.csv", text);
  const auto at = times(folder, 30 * kPeriod, 1450 * kPeriod, 1'700'000);
  std::string kinds;
  const auto samples =
      columns_of(through_a_stream(file, at, {"--kind", "heading:periodic:360"}, kinds));
  EXPECT_EQ(kinds, R"(["periodic:360","linear"])");
  int crossings = 0;
  for (std::size_t i = 0; i < samples.at("t_ns").size(); ++i) {
    const double t = samples.at("t_ns")[i] / 1e9;
    const double p = samples.at("p[0]")[i];
    ASSERT_TRUE(p >= -180 && p < 180) << p;
    ASSERT_LT(std::abs(std::remainder(p - heading(t), 360.0)), 1e-7) << t;
    ASSERT_LT(std::abs(samples.at("v[0]")[i] - 300 * std::cos(1.2 * t)), 1e-4) << t;
    if (i > 0 && std::abs(p - samples.at("p[0]")[i - 1]) > 180) ++crossings;
  }
  EXPECT_GE(crossings, 5);
}

TEST(KindsPipeline, ACamerasPosesComeThroughBitForBit) {
  const auto file = testing::shared_file("data/tum_rgbd_pose/freiburg1_xyz-groundtruth.txt");
  REQUIRE_SHARED_FILE(file);
  const TestFolder folder;
  ASSERT_EQ(run({"fit", file, "--dt", "0.0031", "-o", folder.path("at.csv")}).code, 0);
  std::string kinds;
  const auto samples = columns_of(through_a_stream(file, folder.path("at.csv"), {}, kinds));
  ASSERT_TRUE(samples.contains("alpha[2]"));
  double off_unit = 0;
  for (std::size_t i = 0; i < samples.at("t_ns").size(); ++i) {
    double square = 0;
    for (const char* name : {"p[3]", "p[4]", "p[5]", "p[6]"}) {
      square += samples.at(name)[i] * samples.at(name)[i];
    }
    off_unit = std::max(off_unit, std::abs(std::sqrt(square) - 1));
  }
  EXPECT_LT(off_unit, 1e-15);
  // With `--kind qx:linear` there are no angular columns.
  const auto plain =
      columns_of(through_a_stream(file, folder.path("at.csv"), {"--kind", "qx:linear"}, kinds));
  EXPECT_FALSE(plain.contains("omega[0]"));
}

TEST(KindsPipeline, SamplesAreReadBackWithoutTheirAngularMotion) {
  const TestFolder folder;
  const auto file = folder.write("a.csv", coning_csv("t_ns,x,qx,qy,qz,qw", false));
  const auto samples = folder.path("samples.csv");
  ASSERT_EQ(run({"fit", file, "--dt", "0.1", "-o", samples}).code, 0);
  EXPECT_EQ(read_waypoints(samples, {}).dimensions(), 5U);
}

}  // namespace
}  // namespace splinecast::apps
