#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/fixtures/curves/polynomial_trajectory.hpp"
#include "tests/fixtures/curves/recordings.hpp"
#include "tests/fixtures/processes/process.hpp"
#include "tests/fixtures/processes/shared_files.hpp"

namespace splinecast::apps {
namespace {

using nlohmann::json;
using testing::Ended;
using testing::PolynomialTrajectory;
using testing::run;
using testing::TestFolder;

/// x rises to 1 and returns: the natural c2 spline is 1.5 s − 0.5 s³ at s seconds from either end.
class Check : public ::testing::Test {
 protected:
  [[nodiscard]] std::vector<std::string> check(const std::vector<std::string>& more) const {
    std::vector<std::string> arguments{"check", file_, "--end", "natural"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }

  TestFolder folder_;
  std::string file_ = folder_.write("hill.csv", "t,x,y\n0,0,5\n1,1,5\n2,0,5\n");
};

TEST_F(Check, ReportsTheWorstOfEachKindAndExitsWith0IfAllLimitsHold) {
  const Ended ended = run(check({"--max-velocity", "1.6", "--max-acceleration", "3.1,none",
                                 "--max-jerk", "4", "--bounds", "-1:2,4:6", "--json"}));
  ASSERT_EQ(ended.code, 0) << ended.err;
  const auto found = json::parse(ended.out);
  EXPECT_EQ(found["keeps_limits"], true);
  EXPECT_EQ(found["segments"], 2);
  EXPECT_EQ(found["segments_beyond"], 0);
  EXPECT_EQ(found["first_violation"], nullptr);
  EXPECT_EQ(found["slowing"], 1);
  EXPECT_NEAR(found["worst"]["velocity"]["ratio"], 1.5 / 1.6, 1e-12);
  EXPECT_NEAR(found["worst"]["acceleration"]["value"], -3, 1e-12);
  EXPECT_EQ(found["worst"]["acceleration"]["time_ns"], 1'000'000'000);
  EXPECT_NEAR(found["worst"]["jerk"]["ratio"], 0.75, 1e-12);
  EXPECT_EQ(found["worst"]["position"]["name"], "x");
  EXPECT_EQ(run(check({"--max-velocity", "1.6"})).err, "");
}

TEST_F(Check, ReportsTheFirstViolationAndTheRequiredSlowing) {
  const Ended ended = run(check({"--max-velocity", "1.5", "--max-acceleration", "1.5", "--json"}));
  ASSERT_EQ(ended.code, 3) << ended.err;
  const auto found = json::parse(ended.out);
  EXPECT_EQ(found["first_violation"]["kind"], "acceleration");
  EXPECT_EQ(found["first_violation"]["name"], "x");
  EXPECT_NEAR(found["first_violation"]["time_ns"], 5e8, 2);  // a = −3 s
  EXPECT_EQ(found["segments_beyond"], 2);
  EXPECT_NEAR(found["slowing"], std::sqrt(0.5), 1e-9);
  EXPECT_EQ(found["slowing_suffices"], true);
  EXPECT_EQ(found["worst"]["jerk"], nullptr);
  const Ended text = run(check({"--max-velocity", "1.5", "--max-acceleration", "1.5"}));
  EXPECT_EQ(text.code, 3);
  EXPECT_NE(text.out.find("first violation"), std::string::npos) << text.out;
  EXPECT_NE(text.out.find("0.7071 times the speed"), std::string::npos) << text.out;
}

TEST_F(Check, SlowingCannotKeepPositionBounds) {
  const Ended ended = run(check({"--bounds", ":0.5,none", "--json"}));
  ASSERT_EQ(ended.code, 3) << ended.err;
  const auto found = json::parse(ended.out);
  EXPECT_EQ(found["slowing_suffices"], false);
  EXPECT_EQ(found["first_violation"]["kind"], "position");
  EXPECT_EQ(found["dimensions_without_limit"], json({"y"}));
  EXPECT_NE(ended.err.find("have no limit: 'y'"), std::string::npos) << ended.err;
  EXPECT_NE(run(check({"--bounds", ":0.5,none"})).out.find("slowing cannot keep the bounds"),
            std::string::npos);
}

TEST_F(Check, RefusesLimitsThatApplyToNoDimensionAndInvalidOptions) {
  const std::vector<std::pair<std::vector<std::string>, std::string>> cases{
      {{}, "needs limits"},
      {{"--max-velocity", "none"}, "none of the limits is for one of its dimensions"},
      {{"--max-velocity", "1,2,3"}, "3 velocity limits for 2 dimensions"},
      {{"--max-velocity", "-1"}, "velocity limit must be positive"},
      {{"--bounds", "2:1"}, "must be below the upper bound"},
      {{"--bounds", "2"}, "'2' is not a list of bounds"},
      {{"--max-jerk", "x"}, "is not a list of numbers"},
      {{"--max-jerk", "1", "--settle", "3"}, "go with --online"},
      {{"--max-jerk", "1", "--method", "wavelet"}, "'wavelet'"},
      {{"--bounds", "-1:1", "--kind", "x:periodic:2"}, "periodic:2, which has no bounds"},
      {{"--limits", folder_.path("none.yaml")}, "none.yaml: no such file"},
  };
  for (const auto& [arguments, text] : cases) {
    const Ended ended = run(check(arguments));
    EXPECT_EQ(ended.code, 2) << text;
    EXPECT_NE(ended.err.find(text), std::string::npos) << text << " is not in: " << ended.err;
    EXPECT_EQ(ended.out, "");
  }
  const auto bad = folder_.write("bad.csv", "t,x\n0,0\n1,nan\n");
  EXPECT_EQ(run({"check", bad, "--max-velocity", "1"}).code, 2);
}

TEST_F(Check, ComparesTheAngularVelocityOfAQuaternion) {
  const auto turn =
      folder_.write("turn.csv",
                    "t,qx,qy,qz,qw\n0,0,0,0,1\n1,0,0,0.09983341664682815,0.9950041652780258\n"
                    "2,0,0,-0.19866933079506122,-0.9800665778412416\n"
                    "3,0,0,0.29552020666133955,0.955336489125606\n");  // 0.2 rad/s about z
  const Ended ended = run({"check", turn, "--max-velocity", "0.25", "--json"});
  ASSERT_EQ(ended.code, 0) << ended.out << ended.err;
  const auto found = json::parse(ended.out);
  EXPECT_NEAR(found["worst"]["velocity"]["value"], 0.2, 0.01);
  EXPECT_EQ(found["worst"]["velocity"]["dimension"], 0);
  EXPECT_EQ(found["dimensions_without_limit"], json::array());
  EXPECT_EQ(run({"check", turn, "--max-velocity", "0.19"}).code, 3);
}

/// The largest absolute value of a derivative, and its time.
struct Peak {
  double value = 0;
  double time = 0;
};

std::array<Peak, PolynomialTrajectory::kDimensions> peaks_of(const PolynomialTrajectory& flight,
                                                             int derivative) {
  std::array<Peak, PolynomialTrajectory::kDimensions> peaks{};
  for (int i = 0; i <= 20'000; ++i) {
    const double t = flight.duration() * i / 20'000;
    const auto values = flight.at(t, derivative);
    for (std::size_t d = 0; d < peaks.size(); ++d) {
      if (std::abs(values[d]) > peaks[d].value) peaks[d] = {std::abs(values[d]), t};
    }
  }
  return peaks;
}

/// A robot whose joints x0 to x3 have a share of the peaks as velocity limit.
std::string urdf_of(const std::array<Peak, PolynomialTrajectory::kDimensions>& peaks,
                    double share) {
  std::string urdf = "<robot name=\"flight\">\n<link name=\"l0\"/>\n";
  for (std::size_t d = 0; d < peaks.size(); ++d) {
    const double velocity = peaks[d].value > 0 ? share * peaks[d].value : 1;
    urdf += fmt::format(
        "<link name=\"l{1}\"/>\n<joint name=\"x{0}\" type=\"prismatic\">\n<parent link=\"l{0}\"/>"
        "<child link=\"l{1}\"/>\n<limit lower=\"-2\" upper=\"2\" effort=\"1\" velocity=\"{2}\"/>\n"
        "</joint>\n",
        d, d + 1, velocity);
  }
  return urdf +
         "<link name=\"tool\"/>\n<joint name=\"flange\" type=\"fixed\"><parent link=\"l4\"/>"
         "<child link=\"tool\"/></joint>\n</robot>\n";
}

TEST_F(Check, FindsThePeakVelocitiesOfAKnownFlight) {
  const auto path = testing::shared_file("data/crazyswarm2_poly/figure8.csv");
  REQUIRE_SHARED_FILE(path);
  const PolynomialTrajectory flight(path);
  const auto file = folder_.write("flight.csv", to_csv(flight.sampled(Time(50'000'000))));
  const auto peaks = peaks_of(flight, 1);
  const auto keeps = folder_.write("keeps.urdf", urdf_of(peaks, 1.01));
  const Ended kept = run({"check", file, "--limits", keeps, "--json"});
  if (kept.err.find("this build cannot read") != std::string::npos) GTEST_SKIP() << kept.err;
  ASSERT_EQ(kept.code, 0) << kept.out << kept.err;
  const auto found = json::parse(kept.out);
  EXPECT_NEAR(found["worst"]["velocity"]["ratio"], 1 / 1.01, 2e-3);
  EXPECT_EQ(found["worst"]["acceleration"], nullptr);
  EXPECT_EQ(found["names_without_dimension"], json::array());
  const auto tight = folder_.write("tight.urdf", urdf_of(peaks, 0.9));
  const Ended passed = run({"check", file, "--limits", tight, "--json"});
  ASSERT_EQ(passed.code, 3) << passed.err;
  const auto beyond = json::parse(passed.out);
  EXPECT_NEAR(beyond["slowing"], 0.9, 2e-3);
  EXPECT_EQ(beyond["first_violation"]["kind"], "velocity");
  const std::size_t worst = beyond["worst"]["velocity"]["dimension"];
  EXPECT_NEAR(beyond["worst"]["velocity"]["time_ns"].get<double>() / 1e9, peaks[worst].time, 0.02);
  // An option replaces the limits of its kind from the file.
  EXPECT_EQ(run({"check", file, "--limits", tight, "--max-velocity", "9"}).code, 0);
}

}  // namespace
}  // namespace splinecast::apps
