#include "apps/replay/lead.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <vector>

#include "tests/fixtures/processes/process.hpp"

/// The lead of a live replay.
namespace splinecast::apps {
namespace {

using std::chrono::milliseconds;
using testing::Ended;

/// Of a recording with equal intervals.
Survey steady_survey(milliseconds interval, std::size_t rows) {
  std::vector<Time> intervals(rows - 1, interval);
  Survey survey{.rows = rows, .last = static_cast<int>(rows - 1) * interval};
  if (rows > 1) survey.intervals = measure_intervals(intervals, interval);
  return survey;
}

class ReplayLead : public ::testing::Test {
 protected:
  ReplayLead() {
    board_.clock = static_cast<std::uint64_t>(StreamClock::monotonic);
    board_.settle = 8;
    board_.freeze_ahead = 5'000'000;
    board_.stop_time = 250'000'000;
  }
  /// Chooses the lead, and stores the message about it in `said_`.
  Time lead(const Survey& survey, const ReplayOptions& options) {
    ::testing::internal::CaptureStderr();
    const Time lead = choose_lead(survey, options, board_);
    said_ = ::testing::internal::GetCapturedStderr();
    return lead;
  }

  ipc::RegionHeader board_{};
  std::string said_;
};

TEST_F(ReplayLead, Is200MillisecondsIfThatSuffices) {
  EXPECT_EQ(lead(steady_survey(milliseconds(10), 500), {.stream = "arm"}), milliseconds(200));
  EXPECT_EQ(said_, "");
}

TEST_F(ReplayLead, IsTheDepthThatKNeedsForASlowRecordingAndReportsWhy) {
  EXPECT_EQ(lead(steady_survey(milliseconds(40), 500), {.stream = "arm"}), milliseconds(365));
  EXPECT_EQ(said_,
            "splinecast: 'arm': lead 365 ms: freeze-ahead 5 ms + 9 intervals of 40 ms = 365 ms, "
            "and jitter of 0 ms\n");
  EXPECT_EQ(lead(steady_survey(milliseconds(40), 6), {.stream = "arm"}), milliseconds(205));
  EXPECT_EQ(lead(steady_survey(milliseconds(40), 6), {.stream = "arm", .loops = 2}),
            milliseconds(365));
}

TEST_F(ReplayLead, IsUsedWithAWarningIfItIsTooShort) {
  const Survey survey = steady_survey(milliseconds(10), 500);
  EXPECT_EQ(lead(survey, {.stream = "arm", .lead = milliseconds(60)}), milliseconds(60));
  EXPECT_EQ(said_,
            "splinecast: 'arm': the lead of 60 ms is less than the 95 ms that K = 8 needs; a "
            "silence of 100 ms: starves for 55 ms and does not come to rest\n");
  EXPECT_EQ(lead(survey, {.stream = "arm", .lead = milliseconds(95)}), milliseconds(95));
  EXPECT_EQ(said_, "");
  EXPECT_EQ(lead(survey, {.stream = "arm", .lead = milliseconds(60), .quiet = true}),
            milliseconds(60));
  EXPECT_EQ(said_, "");
}

TEST_F(ReplayLead, GivesNoMessageIfItDoesNotMatter) {
  const Survey slow = steady_survey(milliseconds(400), 500);
  EXPECT_EQ(lead(slow, {.stream = "arm", .rate = std::nullopt}), milliseconds(200));
  EXPECT_EQ(lead(steady_survey(milliseconds(400), 1), {.stream = "arm"}), milliseconds(200));
  board_.clock = static_cast<std::uint64_t>(StreamClock::recorded);
  EXPECT_EQ(lead(slow, {.stream = "arm"}), milliseconds(200));
  EXPECT_EQ(said_, "");
}

TEST_F(ReplayLead, UsesTheSettleLagOfTheSolver) {
  const testing::TestStream stream;
  const testing::TestFolder folder;
  const auto file = folder.write("a.csv", "t,x\n0,0\n0.1,1\n0.2,2\n0.3,1\n0.4,0\n0.5,0\n");
  const Ended ended =
      testing::run({"replay", file, "--stream", stream.name(), "--embedded", "--settle", "2"});
  EXPECT_EQ(ended.code, 0) << ended.err;
  EXPECT_NE(ended.err.find("lead 305 ms: freeze-ahead 5 ms + 3 intervals of 100 ms"),
            std::string::npos)
      << ended.err;
}

}  // namespace
}  // namespace splinecast::apps
