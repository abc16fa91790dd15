#include <gtest/gtest.h>

#include <csignal>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "splinecast/method.hpp"
#include "tests/fixtures/curves/method_trial.hpp"
#include "tests/fixtures/curves/recordings.hpp"
#include "tests/fixtures/processes/process.hpp"
#include "tests/fixtures/processes/shared_files.hpp"

// Every method of the program, in real processes.
namespace splinecast::apps {
namespace {

using nlohmann::json;
using testing::Ended;
using testing::Process;
using testing::run;
using testing::TestFolder;
using testing::TestStream;

using Arguments = std::vector<std::string>;

Arguments operator+(Arguments a, const Arguments& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

/// A recording of two dimensions with velocities and accelerations.
std::string recording(const TestFolder& folder, std::size_t knots) {
  const testing::Trial trial = testing::random_trial(3, knots, 2, 4);
  const Waypoints all = trial.waypoints();
  std::string text = "t_ns,x,y,v[0],v[1],a[0],a[1]\n";
  for (std::size_t i = 0; i < knots; ++i) {
    text += std::to_string(all.times[i].count());
    for (const auto values : {all[i].position, all[i].velocity, all[i].acceleration}) {
      for (const double x : values) text += ',' + json(x).dump();
    }
    text += '\n';
  }
  return folder.write("moves.csv", text);
}

/// The parameters of the method.
Arguments parameters(const Method& method) {
  if (method.smooths()) return {"--lambda", "1e-9"};
  if (!method.laws.is_scale_free) return {"--time-scale", "0.5"};
  return {};
}

class MethodsOfTheProgram : public ::testing::TestWithParam<const Method*> {};

TEST_P(MethodsOfTheProgram, GoThroughThreeProcessesBitForBit) {
  const Method& method = *GetParam();
  const TestFolder folder;
  const auto file = recording(folder, 2000);
  const auto curve = Arguments{"--method", std::string(method.name)} + parameters(method);
  const Ended batch = run(Arguments{"fit", file, "--dt", "0.003", "--gap", "bridge"} + curve);
  ASSERT_EQ(batch.code, 0) << batch.err;
  const auto at = folder.write("at.csv", batch.out);
  const Ended fitted =
      run(Arguments{"fit", file, "--at", at, "--online", "--gap", "bridge"} + curve);
  if (!method.streams()) {
    EXPECT_EQ(fitted.code, 2);
    EXPECT_NE(fitted.err.find("all waypoints at once"), std::string::npos) << fitted.err;
    const Ended solved = run(Arguments{"solve", "nothing"} + curve);
    EXPECT_EQ(solved.code, 2);
    EXPECT_NE(solved.err.find("all waypoints at once"), std::string::npos) << solved.err;
    return;
  }
  ASSERT_EQ(fitted.code, 0) << fitted.err;
  const TestStream stream;
  Process solver(Arguments{"solve", stream.name()} + curve);
  const Ended sent = run({"replay", file, "--stream", stream.name(), "--rate", "max", "--clock",
                          "recorded", "--gap", "bridge"});
  ASSERT_EQ(sent.code, 0) << sent.err;
  const Ended sampled = run({"sample", stream.name(), "--at", at});
  ASSERT_EQ(sampled.code, 0) << sampled.err;
  EXPECT_TRUE(testing::same_text(testing::without_status(sampled.out), fitted.out));
  if (!method.converges()) {
    EXPECT_TRUE(testing::same_text(fitted.out, batch.out));
  }
  EXPECT_EQ(testing::info(stream.name())["solver"]["method"], method.name);
  solver.signal(SIGTERM);
  EXPECT_EQ(solver.wait().code, 0);
}

std::vector<const Method*> all_methods() {
  std::vector<const Method*> all;
  for (const Method& method : methods()) all.push_back(&method);
  return all;
}

INSTANTIATE_TEST_SUITE_P(Every, MethodsOfTheProgram, ::testing::ValuesIn(all_methods()),
                         [](const auto& tested) { return std::string(tested.param->name); });

TEST(MethodsVerb, ListsEveryMethod) {
  const Ended listed = run({"methods"});
  ASSERT_EQ(listed.code, 0) << listed.err;
  for (const Method& method : methods()) {
    EXPECT_NE(listed.out.find(method.name), std::string::npos) << method.name;
  }
}

TEST(MethodsVerb, MeasuresAgainstATrajectory) {
  const TestFolder folder;
  // x = t³ − t, y = 2t in two pieces.
  const auto cubic = folder.write("cubic.csv",
                                  "duration,x^0,x^1,x^2,x^3,y^0,y^1,y^2,y^3\n# a comment\n\n"
                                  "1,0,-1,0,1,0,2,0,0,\n1,0,2,3,1,2,2,0,0\n");
  const Ended measured = run({"methods", "--against", cubic, "--every", "0.05", "--json"});
  ASSERT_EQ(measured.code, 0) << measured.err;
  for (const json& row : json::parse(measured.out)) {
    const bool reproduces = find_method(row["method"].get<std::string>())->laws.degree >= 3;
    const double error = row["errors"][0];
    if (reproduces && (row["settle"].is_null() || row["settle"] == 1 || row["settle"] == 16)) {
      EXPECT_LT(error, row["method"] == "c2" && row["settle"] == 1 ? 1e-4 : 1e-9) << row.dump();
    } else {
      EXPECT_LT(error, 0.1) << row.dump();
    }
    if (!reproduces) {
      EXPECT_GT(error, 1e-9) << row.dump();
    }
  }
}

TEST(MethodsVerb, MeasuresBeforeAndAfterAJumpOfTheTrajectory) {
  const TestFolder folder;
  const auto jumping = folder.write("a.csv", "duration,x^0,x^1\n1,0,1\n1,5,1\n");
  const Ended measured = run({"methods", "--against", jumping, "--json"});
  ASSERT_EQ(measured.code, 0) << measured.err;
  EXPECT_NE(measured.err.find("jumps by 4 at 1 s"), std::string::npos) << measured.err;
  for (const json& row : json::parse(measured.out)) EXPECT_LT(row["errors"][0], 1e-6) << row.dump();
}

TEST(MethodsVerb, OmitsDerivativesThatTheTrajectoryDoesNotHave) {
  const TestFolder folder;
  const auto straight = folder.write("a.csv", "duration,x^0,x^1\n1,0,1\n");
  const Ended measured = run({"methods", "--against", straight, "--json"});
  ASSERT_EQ(measured.code, 0) << measured.err;
  for (const json& row : json::parse(measured.out)) {
    EXPECT_LT(row["errors"][0], 1e-12);
    EXPECT_TRUE(row["errors"][2].is_null()) << row.dump();
  }
}

TEST(MethodsVerb, ReportsErrorsInATrajectory) {
  const TestFolder folder;
  const std::vector<std::pair<std::string, std::string>> cases{
      {"", "there is no header"},
      {"duration,x^0\n", "there are no rows"},
      {"duration,x\n1,2\n", "a.csv:1: column 'x' has no valid power"},
      {"duration,x^0,x^99\n1,2,3\n", "column 'x^99'"},
      {"duration,x^0\n1\n", "a.csv:2: 1 fields; the header has 2"},
      {"duration,x^0\n0,1\n", "a.csv:2: '0' is not a duration"},
      {"duration,x^0\n1e9,1\n", "is not a duration above 0 and up to 366 days"},
      {"duration,x^0\n20000000,1\n20000000,1\n", "a.csv:3: the trajectory is longer"},
      {"duration,x^0,x^0\n1,1,1\n", "column 'x^0' occurs twice"},
      {"duration,^0\n1,1\n", "column '^0' has no dimension name"},
      {"x^0,x^1\n1,1\n", "the first column is not 'duration'"},
      {"duration,x^0\n0.01,1\n", "no trajectory lasts as long as --every"},
      {"duration,x^0\n100000,1\n", "choose a longer --every"},
      {"duration,x^0\n1,nan\n", "column 'x^0': 'nan' is not a number from -1e100 to 1e100"},
  };
  for (const auto& [text, message] : cases) {
    const Ended ended = run({"methods", "--against", folder.write("a.csv", text)});
    EXPECT_EQ(ended.code, 2);
    EXPECT_NE(ended.err.find(message), std::string::npos) << message << " not in " << ended.err;
  }
}

TEST(Fit, ChoosesLambdaAndReportsIt) {
  const TestFolder folder;
  const auto file = recording(folder, 60);
  const Arguments fit{"fit", file, "--method", "smoothing", "--dt", "0.01"};
  const Ended chosen = run(fit);
  ASSERT_EQ(chosen.code, 0) << chosen.err;
  const std::string before = "splinecast: lambda ";
  const auto at = chosen.err.find(before);
  ASSERT_NE(at, std::string::npos) << chosen.err;
  const auto begin = at + before.size();
  const std::string lambda = chosen.err.substr(begin, chosen.err.find(' ', begin) - begin);
  EXPECT_EQ(run(fit + Arguments{"--lambda", lambda}).out, chosen.out);
  EXPECT_EQ(run(fit + Arguments{"--lambda", "auto"}).out, chosen.out);
}

TEST(Fit, RefusesOptionsThatDoNotFitTheMethod) {
  const TestFolder folder;
  const auto file = folder.write("a.csv", "t,x\n0,0\n1,1\n2,4\n3,1\n");
  const std::vector<std::pair<Arguments, std::string>> cases{
      {{"--method", "hermite"}, "needs columns v[0] to v[0]"},
      {{"--method", "quintic"}, "needs columns v[0]"},
      {{"--method", "akima", "--lambda", "1"}, "--method smoothing only"},
      {{"--method", "akima", "--time-scale", "1"}, "--method rounded only"},
      {{"--online", "--force-lag"}, "--method smoothing only"},
      {{"--start", "own"}, "'own'"},
      {{"--method", "akima", "--online", "--settle", "1"}, "must be 2 to 64, not 1"},
      {{"--method", "smoothing", "--online", "--tail", "clamped", "--lambda", "1"},
       "the tail of method smoothing is fixed"},
      {{"--method", "smoothing", "--online"}, "cross-validation needs all waypoints"},
      {{"--method", "smoothing", "--online", "--lambda", "auto"}, "all waypoints at once"},
      {{"--method", "smoothing", "--lambda", "-1"}, "'-1'"},
      {{"--method", "smoothing", "--online", "--lambda", "1", "--settle", "8"}, "too short"},
      {{"--method", "normalized", "--start", "clamped"}, "ends naturally"},
      {{"--method", "bessel", "--end", "not-a-knot"}, "is for c2"},
      {{"--start", "periodic"}, "other end periodic"},
      {{"--start", "periodic", "--end", "periodic"}, "last position equal"},
      {{"--method", "akima,pchip"}, "--report as the only output"},
  };
  for (const auto& [arguments, text] : cases) {
    const Ended ended = run(Arguments{"fit", file, "--dt", "1"} + arguments);
    EXPECT_EQ(ended.code, 2) << text;
    EXPECT_NE(ended.err.find(text), std::string::npos) << text << " is not in: " << ended.err;
  }
  const auto two = folder.write("b.csv", "t,x\n0,0\n1,1\n");
  const Ended ended = run({"fit", two, "--dt", "1", "--start", "not-a-knot"});
  EXPECT_EQ(ended.code, 2);
  EXPECT_NE(ended.err.find("needs 3 waypoints; there are 2"), std::string::npos) << ended.err;
}

TEST(Solve, RefusesOptionsThatDoNotFitTheMethod) {
  const std::vector<std::pair<Arguments, std::string>> cases{
      {{"--lambda", "1"}, "lambda is for method smoothing, not for c2"},
      {{"--method", "pchip", "--force-lag"}, "only for method smoothing, not for pchip"},
      {{"--method", "akima", "--time-scale", "2"}, "for method rounded, not for akima"},
      {{"--method", "smoothing", "--lambda", "1", "--tail", "clamped"},
       "the tail of method smoothing is fixed"},
      {{"--method", "smoothing"}, "needs a lambda"},
  };
  const TestStream stream;
  for (const auto& [arguments, text] : cases) {
    const Ended ended = run(Arguments{"solve", stream.name()} + arguments);
    EXPECT_EQ(ended.code, 2) << text;
    EXPECT_NE(ended.err.find(text), std::string::npos) << text << " is not in: " << ended.err;
  }
}

TEST(Fit, NamesTheLineWhereALagIsTooShortForLambda) {
  const TestFolder folder;
  std::string text = "t,x\n";
  for (int i = 0; i < 40; ++i) text += json(0.01 * i).dump() + ",0\n";
  const auto file = folder.write("a.csv", text);
  const Arguments fit{"fit",      file,   "--dt",     "1",  "--method", "smoothing",
                      "--lambda", "1e-5", "--settle", "20", "--online"};
  const Ended refused = run(fit);
  EXPECT_EQ(refused.code, 2);
  EXPECT_NE(refused.err.find("a.csv:22: settle lag 20 is too short"), std::string::npos)
      << refused.err;
  EXPECT_EQ(run(fit + Arguments{"--force-lag"}).code, 0);
}

TEST(Replay, OfWaypointsThatTheMethodCannotUseFailsWithTheReason) {
  const TestFolder folder;
  const TestStream stream;
  const auto file = folder.write("a.csv", "t,x\n0,0\n1,1\n2,4\n");
  const Arguments replay{"replay",  file,       "--stream",   stream.name(), "--rate", "max",
                         "--clock", "recorded", "--embedded", "--method",    "hermite"};
  const Ended ended = run(replay);
  EXPECT_EQ(ended.code, 1);
  EXPECT_NE(ended.err.find("0 interpolated, 3 refused (3 lacks derivatives)"), std::string::npos)
      << ended.err;
}

}  // namespace
}  // namespace splinecast::apps
