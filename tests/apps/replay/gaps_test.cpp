#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "apps/process/exit_codes.hpp"
#include "apps/streams/rows.hpp"
#include "tests/fixtures/curves/recordings.hpp"
#include "tests/fixtures/processes/process.hpp"
#include "tests/fixtures/processes/shared_files.hpp"

/// `replay` and `fit` of recordings with gaps.
namespace splinecast::apps {
namespace {

using nlohmann::json;
using testing::Ended;
using testing::run;

/// A sine wave at 100 Hz with a gap of 12 s, in the middle of the motion.
std::string with_a_gap() {
  std::string text = "t,x [rad]\n";
  for (int i = 0; i <= 200; ++i) {
    const double s = 0.01 * i;
    text += fmt::format("{},{}\n", i <= 100 ? s : s + 12, std::sin(3 * s));
  }
  return text;
}

/// A row of samples: time in s, position, velocity.
struct Sample {
  double t, x, v;
};

std::vector<Sample> samples_of(const std::string& csv) {
  std::vector<Sample> samples;
  std::istringstream lines(csv);
  std::string line;
  std::getline(lines, line);  // the header
  while (std::getline(lines, line)) {
    Sample sample{};
    if (std::sscanf(line.c_str(), "%lf,%lf,%lf", &sample.t, &sample.x, &sample.v) != 3) continue;
    sample.t *= 1e-9;
    samples.push_back(sample);
  }
  return samples;
}

class ReplayGaps : public ::testing::Test {
 protected:
  [[nodiscard]] Ended replay(const std::string& file, const std::vector<std::string>& more) const {
    std::vector<std::string> arguments{"replay",     file,     "--stream", stream_.name(),
                                       "--embedded", "--json", "--verify"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run(arguments);
  }
  [[nodiscard]] Ended replay_recorded(const std::string& file,
                                      std::vector<std::string> more = {}) const {
    more.insert(more.end(), {"--clock", "recorded", "--rate", "max"});
    return replay(file, more);
  }
  /// Samples every 10 ms of a stream that begins at 0.
  [[nodiscard]] std::vector<Sample> samples(int count) const {
    return samples_of(
        run({"sample", stream_.name(), "--rate", "100", "--count", std::to_string(count)}).out);
  }

  testing::TestFolder folder_;
  testing::TestStream stream_;
};

TEST_F(ReplayGaps, TheMotionStopsAtAGapAndMeetsTheFirstWaypointAfterIt) {
  const Ended ended = replay_recorded(folder_.write("a.csv", with_a_gap()));
  ASSERT_EQ(ended.code, kOk) << ended.err;
  const json report = json::parse(ended.out);
  EXPECT_EQ(report["gaps"]["policy"], "split");
  EXPECT_EQ(report["gaps"]["count"], 1);
  EXPECT_EQ(report["gaps"]["longest"][0]["after"], 102);
  EXPECT_EQ(report["gaps"]["longest"][0]["before"], 103);
  EXPECT_EQ(report["interpolated"], 201);
  EXPECT_TRUE(report["verification"]["difference"].is_null());
  double largest = 0;
  for (const Sample& at : samples(1401)) {
    largest = std::max(largest, std::abs(at.v));
    if (at.t > 1.3 && at.t < 11) {
      EXPECT_EQ(at.v, 0) << at.t;
    }
    if (std::abs(at.t - 13.01) < 1e-6) {
      EXPECT_NEAR(at.x, std::sin(3 * 1.01), 1e-12);
    }
  }
  EXPECT_LT(largest, 6);
}

TEST_F(ReplayGaps, ABridgedGapIsOneSegment) {
  const Ended ended = replay_recorded(folder_.write("a.csv", with_a_gap()), {"--gap", "bridge"});
  ASSERT_EQ(ended.code, kOk) << ended.err;
  EXPECT_EQ(json::parse(ended.out)["gaps"]["policy"], "bridge");
  EXPECT_EQ(json::parse(ended.out)["gaps"]["count"], 1);
  EXPECT_EQ(json::parse(ended.out)["verification"]["equal"], 200);
  bool rests = false;
  for (const Sample& at : samples(1401)) rests = rests || (at.t > 1 && at.t < 13 && at.v == 0);
  EXPECT_FALSE(rests);
}

TEST_F(ReplayGaps, ARefusedGapIsReportedBeforeAnythingIsSent) {
  const Ended ended = replay_recorded(folder_.write("a.csv", with_a_gap()), {"--gap", "1:refuse"});
  EXPECT_EQ(ended.code, kBadUsageOrInput);
  EXPECT_NE(ended.err.find("a.csv:103: a gap of 12.01 s after"), std::string::npos) << ended.err;
  EXPECT_TRUE(testing::info(stream_.name()).is_null());
}

TEST_F(ReplayGaps, TheMaximumIntervalDoesNotRefuseWhatFollowsAGap) {
  const auto file = folder_.write("a.csv", with_a_gap());
  const Ended split = replay_recorded(file, {"--max-interval", "1"});
  ASSERT_EQ(split.code, kOk) << split.err;
  EXPECT_EQ(json::parse(split.out)["interpolated"], 201);
  const Ended bridge = replay_recorded(file, {"--max-interval", "1", "--gap", "bridge"});
  EXPECT_EQ(bridge.code, kBadUsageOrInput);
  EXPECT_NE(bridge.err.find("too far apart"), std::string::npos) << bridge.err;
}

/// A motion from rest at 100 Hz for 0.8 s, with a gap of 1.2 s in the middle.
std::string live_with_a_gap() {
  std::string text = "t,x\n";
  for (int i = 0; i <= 80; ++i) {
    const double s = 0.01 * i;
    text += fmt::format("{},{}\n", i <= 40 ? s : s + 1.2, 1 - std::cos(3 * s));
  }
  return text;
}

TEST_F(ReplayGaps, ALiveStreamStopsWhetherTheGapIsShorterOrLongerThanTheLead) {
  for (const char* const lead : {"2500", "300"}) {
    const Ended ended = replay(folder_.write("a.csv", live_with_a_gap()),
                               {"--lead", lead, "--on-error", "skip", "--start-from", "first"});
    ASSERT_EQ(ended.code, kOk) << ended.err;
    const json report = json::parse(ended.out);
    EXPECT_EQ(report["gaps"]["count"], 1);
    EXPECT_TRUE(report["verification"]["difference"].is_null()) << ended.out;
    const json solver = testing::info(stream_.name())["solver"];
    const auto first = solver["newest_knot_ns"].get<std::int64_t>() - 2'000'000'000;
    std::string at = "t_ns\n";
    for (int ms = 700; ms < 1100; ms += 5) at += fmt::format("{}\n", first + ms * 1'000'000LL);
    for (const Sample& sample :
         samples_of(run({"sample", stream_.name(), "--at", folder_.write("at.csv", at)}).out)) {
      EXPECT_EQ(sample.v, 0) << lead << ' ' << sample.t;
    }
  }
}

TEST_F(ReplayGaps, EachLoopSplitsTheGapAgain) {
  const Ended ended = replay_recorded(folder_.write("a.csv", with_a_gap()), {"--loop", "3"});
  ASSERT_EQ(ended.code, kOk) << ended.err;
  const json report = json::parse(ended.out);
  EXPECT_EQ(report["sent"], 603);
  EXPECT_EQ(report["interpolated"], 603);
  EXPECT_TRUE(report["verification"]["difference"].is_null());
}

TEST_F(ReplayGaps, ManyGapsAreSplitBitForBit) {
  std::string text = "t,x,y\n";
  for (int i = 0; i < 3000; ++i) {
    text += fmt::format("{:.3f},{},{}\n", 0.01 * i + (i / 7) * 1.5, std::sin(0.1 * i), 0.01 * i);
  }
  for (const char* const method : {"c2", "akima", "pchip"}) {
    const Ended ended = replay_recorded(folder_.write("a.csv", text), {"--method", method});
    ASSERT_EQ(ended.code, kOk) << ended.err;
    const json report = json::parse(ended.out);
    EXPECT_EQ(report["gaps"]["count"], 428);
    EXPECT_EQ(report["interpolated"], 3000) << method << ": fewer rows than K between two gaps";
    EXPECT_TRUE(report["verification"]["difference"].is_null()) << method << ended.out;
  }
}

TEST_F(ReplayGaps, NamesAndUnitsOfColumnsBecomeThoseOfTheStream) {
  const Ended ended = replay_recorded(folder_.write("a.csv", with_a_gap()));
  ASSERT_EQ(ended.code, kOk) << ended.err;
  EXPECT_EQ(testing::info(stream_.name())["names"], json::array({"x"}));
  EXPECT_EQ(read_stream_rows(stream_.name(), {}).names, std::vector<std::string>{"x [rad]"});
}

TEST_F(ReplayGaps, OfRealRecordingsAreSplit) {
  const auto file = testing::shared_file("data/tum_rgbd_pose/freiburg1_xyz-groundtruth.txt");
  REQUIRE_SHARED_FILE(file);
  const Ended ended = replay_recorded(file.string(), {"--gap", "0.011", "--on-error", "skip"});
  ASSERT_EQ(ended.code, kOk) << ended.err;
  const json report = json::parse(ended.out);
  EXPECT_GT(report["gaps"]["count"], 0);
  EXPECT_TRUE(report["verification"]["difference"].is_null()) << ended.out.substr(0, 2000);
}

class FitGaps : public ::testing::Test {
 protected:
  [[nodiscard]] Ended fit(const std::vector<std::string>& more) const {
    std::vector<std::string> arguments{"fit", folder_.write("a.csv", with_a_gap())};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run(arguments);
  }
  testing::TestFolder folder_;
};

TEST_F(FitGaps, EachMethodHaltsAtBothEndsOfAGapAndDoesNotSwing) {
  for (const char* const method :
       {"c2", "akima", "makima", "pchip", "bessel", "smoothing", "rounded"}) {
    for (const std::vector<std::string>& more :
         {std::vector<std::string>{}, std::vector<std::string>{"--online"}}) {
      std::vector<std::string> arguments{"--method", method, "--dt", "0.01"};
      arguments.insert(arguments.end(), more.begin(), more.end());
      if (std::string(method) == "smoothing") arguments.insert(arguments.end(), {"--lambda", "0"});
      const Ended ended = fit(arguments);
      ASSERT_EQ(ended.code, kOk) << ended.err;
      EXPECT_NE(ended.err.find("1 gap split, the longest 12.01 s from line 102 to line 103"),
                std::string::npos)
          << ended.err;
      const auto samples = samples_of(ended.out);
      ASSERT_EQ(samples.size(), 1401U);
      EXPECT_NEAR(samples[100].v, 0, 1e-9) << method;
      EXPECT_NEAR(samples[1301].v, 0, 1e-9) << method;
      const double low = std::min(std::sin(3.0), std::sin(3.03));
      for (std::size_t i = 100; i <= 1301; ++i) {
        ASSERT_GT(samples[i].x, low - 1e-6) << method << ' ' << i;
        ASSERT_LT(samples[i].x, 0.15) << method << ' ' << i;
      }
    }
  }
}

TEST_F(FitGaps, TheCurveHasNoSteps) {
  const auto samples = samples_of(fit({"--dt", "0.0001"}).out);
  for (std::size_t i = 1; i < samples.size(); ++i) {
    ASSERT_NEAR(samples[i].x, samples[i - 1].x, 4e-3) << samples[i].t;
    ASSERT_NEAR(samples[i].v, samples[i - 1].v, 0.5) << samples[i].t;
  }
}

TEST_F(FitGaps, ABridgedGapIsOneCubic) {
  const json bridged = json::parse(fit({"--emit", "pp", "--gap", "bridge"}).out);
  EXPECT_EQ(bridged["breaks_ns"].size(), 201U);
  const json split = json::parse(fit({"--emit", "pp"}).out);
  EXPECT_EQ(split["breaks_ns"].size(), 201U);
  EXPECT_NE(bridged["coefficients"], split["coefficients"]);
}

TEST_F(FitGaps, AMethodThatCannotHaltIsRefused) {
  const Ended ended = fit({"--dt", "1", "--method", "normalized"});
  EXPECT_EQ(ended.code, kBadUsageOrInput);
  EXPECT_NE(ended.err.find("method normalized cannot halt"), std::string::npos) << ended.err;
  EXPECT_EQ(fit({"--dt", "1", "--gap", "refuse"}).code, kBadUsageOrInput);
  EXPECT_EQ(fit({"--dt", "1", "--gap", "20:refuse"}).code, kOk);
}

TEST_F(FitGaps, ASingleWaypointBetweenTwoGapsIsAHalt) {
  const auto file = folder_.write("b.csv", "t,x\n0,0\n0.1,1\n0.2,2\n5,7\n10,3\n10.1,2\n10.2,1\n");
  const auto samples = samples_of(run({"fit", file, "--dt", "0.1"}).out);
  ASSERT_EQ(samples.size(), 103U);
  EXPECT_NEAR(samples[50].x, 7, 1e-9);
  EXPECT_NEAR(samples[50].v, 0, 1e-9);
}

}  // namespace
}  // namespace splinecast::apps
