#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "splinecast/b_spline.hpp"
#include "tests/fixtures/curves/mesh.hpp"
#include "tests/fixtures/curves/recordings.hpp"
#include "tests/fixtures/processes/process.hpp"

namespace splinecast::apps {
namespace {

using nlohmann::json;
using testing::Ended;
using testing::random_mesh;
using testing::run;
using testing::TestFolder;
using testing::to_csv;

using Arguments = std::vector<std::string>;

Arguments operator+(Arguments a, const Arguments& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

/// A Python interpreter with SciPy; tries Debian's first. Empty if there is none.
std::string python_with_scipy() {
  for (const Arguments& start : {Arguments{"/usr/bin/python3"}, {"/usr/bin/env", "python3"}}) {
    const Arguments rest(start.begin() + 1, start.end());
    testing::Process python(start[0], rest + Arguments{"-c", "import scipy.interpolate"});
    if (python.wait().code == 0) return start[0];
  }
  return {};
}

TEST(BSpline, SciPyEvaluatesTheEmittedCurveAndItsControlPointsToTheSamples) {
  const std::string python = python_with_scipy();
  if (python.empty()) GTEST_SKIP() << "no python3 with SciPy (Debian: python3-scipy)";
  const TestFolder folder;
  // SciPy's times are doubles in seconds: over a span T the error of derivatives is eps·T/h.
  const auto mesh = random_mesh(12, 60, 3, 2);
  const auto file = folder.write("waypoints.csv", to_csv(mesh));
  const auto at = folder.write("at.csv", testing::times_csv(mesh, 7));
  for (const Arguments& how :
       {Arguments{}, {"--start", "halt", "--end", "halt"}, {"--online", "--settle", "2"}}) {
    const Arguments fit = Arguments{"fit", file} + how;
    Arguments paths{std::string(SPLINECAST_SOURCE) + "/tests/apps/fit/scipy_check.py"};
    for (const Arguments& emit :
         {Arguments{"--emit", "bspline"}, {"--emit", "bezier"}, {"--at", at}}) {
      paths.push_back(folder.path(emit[1].substr(emit[1].find_last_of('/') + 1) + ".out"));
      const Ended ended = run(fit + emit + Arguments{"-o", paths.back()});
      ASSERT_EQ(ended.code, 0) << ended.err;
    }
    const Ended checked = testing::Process(python, paths).wait();
    ASSERT_EQ(checked.code, 0) << checked.err;
    const json errors = json::parse(checked.out);
    for (const char* format : {"bspline", "bezier"}) {
      ASSERT_EQ(errors.at(format).size(), 4U);
      for (const double error : errors[format]) EXPECT_LE(error, 1e-12) << checked.out;
    }
  }
}

TEST(Emit, WritesKnotsInSecondsFromTheOriginWithOneControlPointPerBasisFunction) {
  const TestFolder folder;
  const auto file = folder.write("a.csv", "t_ns,x,y\n5,0,0\n500000005,1,2\n2000000005,3,6\n");
  const auto b = json::parse(run({"fit", file, "--emit", "bspline"}).out);
  EXPECT_EQ(b.at("degree"), 3);
  EXPECT_EQ(b.at("origin_ns"), 5);
  EXPECT_EQ(b.at("knots"), json::parse("[0.0,0.0,0.0,0.0,0.5,2.0,2.0,2.0,2.0]"));
  ASSERT_EQ(b.at("control_points").size(), 5U);
  EXPECT_EQ(b.at("control_points")[0], json::parse("[0.0,0.0]"));
  EXPECT_NEAR(b.at("control_points")[4][0].get<double>(), 3, 1e-14);
  EXPECT_NEAR(b.at("control_points")[4][1].get<double>(), 6, 1e-14);
}

TEST(Emit, RaisesMixedOrdersToTheHighestAndAddsBreaksToTheControlPoints) {
  const TestFolder folder;
  const auto file = folder.write("a.csv", to_csv(random_mesh(3, 10, 2, 3)));
  const auto bezier = json::parse(run({"fit", file, "--end", "halt", "--emit", "bezier"}).out);
  ASSERT_EQ(bezier.at("breaks_ns").size(), 10U);
  ASSERT_EQ(bezier.at("segments").size(), 9U);
  for (const json& segment : bezier["segments"]) {
    ASSERT_EQ(segment.size(), 6U);
    ASSERT_EQ(segment[0].size(), 2U);
  }
  EXPECT_EQ(json::parse(run({"fit", file, "--end", "halt", "--emit", "bspline"}).out).at("degree"),
            5);
}

TEST(Emit, OneWaypointHasATimeAndEmptyLists) {
  const TestFolder folder;
  const auto file = folder.write("one.csv", "t_ns,x\n5,7\n");
  EXPECT_EQ(run({"fit", file, "--emit", "pp"}).out,
            "{\"breaks_ns\":[5],\"coefficients\":[],\"names\":[\"x\"],\"units\":[\"\"]}\n");
  EXPECT_EQ(run({"fit", file, "--emit", "bezier"}).out,
            "{\"breaks_ns\":[5],\"segments\":[],\"names\":[\"x\"],\"units\":[\"\"]}\n");
  EXPECT_EQ(run({"fit", file, "--emit", "bspline"}).out,
            "{\"degree\":3,\"origin_ns\":5,\"knots\":[],\"control_points\":[],\"names\":[\"x\"],"
            "\"units\":[\"\"]}\n");
}

TEST(Emit, RefusesUnknownFormatsAndTimesForFormatsWithoutSamples) {
  const TestFolder folder;
  const auto file = folder.write("a.csv", "t,x\n0,0\n1,1\n");
  const Ended other = run({"fit", file, "--emit", "nurbs"});
  EXPECT_EQ(other.code, 2);
  EXPECT_NE(other.err.find("'nurbs' is not one of samples, pp, bezier, bspline"), std::string::npos)
      << other.err;
  EXPECT_EQ(run({"fit", file, "--emit", "bspline", "--dt", "1"}).code, 2);
}

}  // namespace
}  // namespace splinecast::apps
