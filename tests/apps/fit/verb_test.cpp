#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

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

/// The rows of a CSV of numbers, without its header.
std::vector<std::vector<double>> rows(const std::string& csv) {
  std::istringstream lines(csv);
  std::string line;
  std::getline(lines, line);
  std::vector<std::vector<double>> all;
  while (std::getline(lines, line)) {
    std::istringstream fields(line);
    std::vector<double> row;
    for (std::string field; std::getline(fields, field, ',');) row.push_back(std::stod(field));
    all.push_back(row);
  }
  return all;
}

TEST(Fit, WritesSamplesEveryDtFromTheFirstWaypoint) {
  const TestFolder folder;
  const auto file = folder.write("a.csv", "t,x\n10,0\n11,1\n12,4\n");
  const Ended ended = run({"fit", file, "--dt", "0.5"});
  ASSERT_EQ(ended.code, 0) << ended.err;
  EXPECT_EQ(ended.out.substr(0, ended.out.find('\n')), "t_ns,p[0],v[0],a[0],j[0]");
  const auto samples = rows(ended.out);
  ASSERT_EQ(samples.size(), 5U);
  EXPECT_EQ(samples[4][0], 12e9);
  EXPECT_NEAR(samples[4][1], 4, 1e-15);
  EXPECT_NEAR(samples[0][3], 0, 1e-15);
  EXPECT_EQ(run({"fit", file, "--dt", "0.5", "-o", folder.path("out.csv")}).out, "");
  EXPECT_EQ(testing::read_file(folder.path("out.csv")), ended.out);
}

TEST(Fit, PiecewisePolynomialsEvaluateToTheSamples) {
  const TestFolder folder;
  const auto mesh = random_mesh(1, 20, 2, 4);
  const auto file = folder.write("a.csv", to_csv(mesh));
  for (const char* end : {"natural", "halt"}) {
    const auto pp = json::parse(run({"fit", file, "--end", end, "--emit", "pp"}).out);
    const std::size_t order = std::string(end) == "halt" ? 6 : 4;
    ASSERT_EQ(pp.at("breaks_ns").size(), 20U);
    ASSERT_EQ(pp.at("coefficients").size(), 19U);
    const auto at = folder.write("at.csv", testing::times_csv(mesh, 3));
    const auto samples = rows(run({"fit", file, "--end", end, "--at", at}).out);
    for (std::size_t q = 0; q + 1 < samples.size(); ++q) {
      const std::size_t segment = q / 3;
      const double u = (samples[q][0] - pp["breaks_ns"][segment].get<double>()) * 1e-9;
      for (std::size_t d = 0; d < 2; ++d) {
        const json& c = pp["coefficients"][segment][d];
        ASSERT_EQ(c.size(), order);
        double p = 0;
        for (const double power : c) p = p * u + power;
        EXPECT_NEAR(p, samples[q][1 + d], 1e-12);
      }
    }
  }
}

TEST(Fit, OnlineWithALongLagEqualsBatchTo1eMinus12) {
  const TestFolder folder;
  const auto file = folder.write("a.csv", to_csv(random_mesh(2, 150, 3, 3)));
  for (const char* condition :
       {"natural", "halt", "clamped", "velocity=1,2,3", "acceleration=-1,0,1"}) {
    const auto batch =
        rows(run({"fit", file, "--start", condition, "--end", condition, "--dt", "0.002"}).out);
    const auto online = rows(run({"fit", file, "--online", "--settle", "48", "--start", condition,
                                  "--end", condition, "--dt", "0.002"})
                                 .out);
    ASSERT_EQ(batch.size(), online.size());
    ASSERT_GT(batch.size(), 100U);
    for (std::size_t k = 0; k < 3; ++k) {
      double scale = 0;
      double error = 0;
      for (std::size_t q = 0; q < batch.size(); ++q) {
        for (std::size_t d = 0; d < 3; ++d) {
          scale = std::max(scale, std::abs(batch[q][1 + 3 * k + d]));
          error = std::max(error, std::abs(batch[q][1 + 3 * k + d] - online[q][1 + 3 * k + d]));
        }
      }
      EXPECT_LE(error, 1e-12 * scale) << condition << ", derivative " << k;
    }
  }
}

TEST(Fit, AddingAnEpochToAllTimesChangesNoSampledBit) {
  const TestFolder folder;
  auto mesh = random_mesh(3, 60, 2, 5);
  const auto strip_times = [](const std::string& csv) {
    std::istringstream lines(csv);
    std::string text;
    for (std::string line; std::getline(lines, line);) text += line.substr(line.find(',')) + "\n";
    return text;
  };
  for (const std::vector<std::string>& how :
       {std::vector<std::string>{}, std::vector<std::string>{"--online"}}) {
    auto near = std::vector<std::string>{"fit", folder.write("a.csv", to_csv(mesh)), "--at",
                                         folder.write("at.csv", testing::times_csv(mesh, 4))};
    near.insert(near.end(), how.begin(), how.end());
    const auto wanted = run(near);
    auto moved = mesh;
    for (auto& t : moved.times) t += Time(1'700'000'000'000'000'000);
    auto far = std::vector<std::string>{"fit", folder.write("b.csv", to_csv(moved)), "--at",
                                        folder.write("bt.csv", testing::times_csv(moved, 4))};
    far.insert(far.end(), how.begin(), how.end());
    const auto got = run(far);
    ASSERT_EQ(got.code, 0) << got.err;
    EXPECT_TRUE(testing::same_text(strip_times(got.out), strip_times(wanted.out)));
    EXPECT_NE(got.out, wanted.out);
  }
}

TEST(Fit, OneWaypointGivesAConstantAndTwoGiveALine) {
  const TestFolder folder;
  const auto one = folder.write("one.csv", "t_ns,x\n5,7\n");
  EXPECT_EQ(run({"fit", one, "--dt", "1"}).out, "t_ns,p[0],v[0],a[0],j[0]\n5,7,0,0,0\n");
  EXPECT_EQ(run({"fit", one, "--online", "--dt", "1"}).out,
            "t_ns,p[0],v[0],a[0],j[0]\n5,7,0,0,0\n");
  EXPECT_EQ(json::parse(run({"fit", one, "--emit", "pp"}).out),
            json::parse(R"({"breaks_ns":[5],"coefficients":[],"names":["x"],"units":[""]})"));
  const auto two = folder.write("two.csv", "t,x\n0,0\n2,4\n");
  EXPECT_EQ(run({"fit", two, "--dt", "1"}).out,
            "t_ns,p[0],v[0],a[0],j[0]\n0,0,2,0,0\n1000000000,2,2,0,0\n2000000000,4,2,0,0\n");
}

TEST(Fit, OverwritesAnOldResultOnlyOnSuccess) {
  const TestFolder folder;
  const auto file = folder.write("a.csv", "t,x\n0,0\n1,1\n2,0\n");
  const auto at = folder.write("at.csv", "t\n0.5\n9\n");
  const auto old = folder.write("old.csv", "old");
  EXPECT_EQ(run({"fit", file, "--at", at, "-o", old}).code, 2);
  EXPECT_EQ(testing::read_file(old), "old");
  EXPECT_EQ(run({"fit", file, "--at", file, "-o", old}).code, 0);
  EXPECT_EQ(std::ranges::count(testing::read_file(old), '\n'), 4);
  EXPECT_EQ(run({"fit", at, "--emit", "pp", "-o", "/dev/full"}).code, 2);
  EXPECT_EQ(run({"fit", file, "--columns", "x", "--emit", "pp", "-o", "/dev/full"}).code, 1);
}

TEST(Fit, ReportsWrongUsageAndInputAndExitsWith2) {
  const TestFolder folder;
  const auto good = folder.write("good.csv", "t,x\n0,0\n1,1\n2,0\n");
  const auto bad_order = folder.write("order.csv", "t,x\n0,0\n1,1\n1,0\n");
  const auto bad_value = folder.write("value.csv", "t,x\n0,0\n1,nan\n");
  const auto outside = folder.write("at.csv", "t\n0.5\n2.5\n");
  const std::vector<std::pair<std::vector<std::string>, std::string>> cases{
      {{"fit", good}, "needs --at or --dt"},
      {{"fit", good, "--report", folder.path("a.html"), "-o", folder.path("a.csv")}, "-o: needs"},
      {{"methods", "--every", "0.1"}, "--every requires --against"},
      {{"fit", good, "--dt", "0"}, "--dt"},
      {{"fit", good, "--dt", "x"}, "'x'"},
      {{"fit", bad_order, "--dt", "1"}, "order.csv:4: time 1000000000 ns is not after"},
      {{"fit", bad_value, "--dt", "1"}, "value.csv:3: column 'x': nan is not finite"},
      {{"fit", good, "--at", outside}, "row 2: time 2500000000 ns is outside the data"},
      {{"fit", good, "--dt", "1", "--start", "velocity=1,2"}, "2 values; 1 are needed"},
      {{"fit", good, "--dt", "1", "--start", "sideways"}, "'sideways'"},
      {{"fit", good, "--online", "--dt", "1", "--end", "not-a-knot"}, "'not-a-knot' needs all"},
      {{"fit", good, "--online", "--dt", "1", "--start", "periodic"}, "'periodic' needs all"},
      {{"fit", good, "--dt", "1", "--settle", "3"}, "go with --online"},
      {{"fit", good, "--dt", "1", "--online", "--settle", "65"}, "65"},
      {{"fit", good, "--dt", "1", "--online", "--tail", "halt"}, "'halt'"},
      {{"fit", good, "--dt", "1", "--method", "wavelet"}, "'wavelet'"},
      {{"fit", good, "--dt", "1", "--time-unit", "h"}, "'h'"},
      {{"fit", folder.path("none.csv"), "--dt", "1"}, "none.csv: no such file"},
      {{"sideways"}, "there is no verb 'sideways'\n"},
      {{"replya"}, "there is no verb 'replya'; the nearest one is 'replay'"},
      {{}, "subcommand"},
  };
  for (const auto& [arguments, text] : cases) {
    const Ended ended = run(arguments);
    EXPECT_EQ(ended.code, 2) << ended.err;
    EXPECT_NE(ended.err.find(text), std::string::npos) << text << " is not in: " << ended.err;
    EXPECT_EQ(ended.out, "");
  }
  EXPECT_EQ(run({"fit", good, "--dt", "1", "-o", "/nowhere/out.csv"}).code, 1);
  EXPECT_EQ(run({"--help"}).code, 0);
  EXPECT_EQ(run({"fit", "--help"}).code, 0);
}

}  // namespace
}  // namespace splinecast::apps
