#include "apps/recordings/preparation.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "apps/recordings/recording.hpp"
#include "apps/tables/table_rows.hpp"
#include "tests/fixtures/processes/process.hpp"

/// The preparation of a recording, in passes.
namespace splinecast::apps {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

/// Rows at these times in ms; the position of each is its time in s, its velocity 1.
WaypointTable table_at(const std::vector<int>& times) {
  WaypointTable table;
  table.file = "a.csv";
  table.names = {"x"};
  table.kinds = {Dimension{}};
  for (const int t : times) {
    table.lines.push_back(table.times.size() + 2);
    table.times.emplace_back(milliseconds(t));
    table.positions.push_back(0.001 * t);
    table.velocities.push_back(1);
  }
  return table;
}

/// The rows of a pass: number, time in ms, velocity, and `*` after a gap.
std::string pass_of(Recording& recording) {
  recording.rewind();
  std::string text;
  for (PreparedRow row; recording.next(row);) {
    text += fmt::format("{}:{}:{}{} ", row.number, row.time / milliseconds(1), row.velocity[0],
                        row.follows_gap ? "*" : "");
  }
  return text;
}

Recording recording_of(const WaypointTable& table, const Preparation& how,
                       RefusedRows* refused = nullptr) {
  return {std::make_unique<TableRows>(table), table.kinds, how, refused};
}

TEST(GapOptions, AreALengthAPolicyOrBoth) {
  EXPECT_EQ(parse_gap("split"), GapOptions{});
  EXPECT_EQ(parse_gap("bridge"), (GapOptions{.policy = GapPolicy::bridge}));
  EXPECT_EQ(parse_gap("0.5"), (GapOptions{.longer_than = milliseconds(500)}));
  EXPECT_EQ(parse_gap("2:refuse"),
            (GapOptions{.policy = GapPolicy::refuse, .longer_than = seconds(2)}));
  for (const char* const bad :
       {"", "0", "-1", "join", "1:", ":split", "1:2", "split:1", "1:split:"}) {
    EXPECT_FALSE(parse_gap(bad)) << bad;
  }
}

TEST(GapOptions, ByDefaultAGapIsTenMediansAndAtLeastHalfASecond) {
  EXPECT_EQ(gap_length({}, milliseconds(10)), milliseconds(500));
  EXPECT_EQ(gap_length({}, milliseconds(100)), seconds(1));
  EXPECT_EQ(gap_length({.longer_than = milliseconds(20)}, milliseconds(100)), milliseconds(20));
}

TEST(Gaps, ListsTheLongestFirst) {
  Gaps gaps;
  for (std::size_t i = 0; i < 30; ++i) {
    gaps.add({.length = milliseconds((i * 7) % 30 + 1), .after = i, .before = i + 1});
  }
  EXPECT_EQ(gaps.count, 30U);
  ASSERT_EQ(gaps.listed, Gaps::kListed);
  for (std::size_t i = 0; i < gaps.listed; ++i) {
    EXPECT_EQ(gaps.largest[i].length, milliseconds(30 - i));
  }
}

TEST(Recording, MarksTheRowAfterAGapAndMeasuresTheRest) {
  const WaypointTable table = table_at({0, 100, 200, 300, 12'300, 12'400, 12'500});
  Recording recording = recording_of(table, {.gap = {}});
  const Survey& survey = recording.survey();
  EXPECT_EQ(survey.rows, 7U);
  EXPECT_EQ(survey.median, milliseconds(100));
  EXPECT_EQ(survey.longest, seconds(12));
  EXPECT_EQ(survey.gaps.count, 1U);
  EXPECT_EQ(survey.gaps.largest[0].after, 5U);
  EXPECT_EQ(survey.gaps.largest[0].before, 6U);
  const std::string wanted = "2:0:1 3:100:1 4:200:1 5:300:1 6:12300:1* 7:12400:1 8:12500:1 ";
  EXPECT_EQ(pass_of(recording), wanted);
  EXPECT_EQ(pass_of(recording), wanted);
  Recording bridged = recording_of(table, {});
  EXPECT_EQ(pass_of(bridged), "2:0:1 3:100:1 4:200:1 5:300:1 6:12300:1 7:12400:1 8:12500:1 ");
}

TEST(Recording, MeasuresGapsInTheTimeOfTheSource) {
  const WaypointTable table = table_at({0, 100, 200, 300, 1400, 1500, 1600});
  Recording fast = recording_of(table, {.rate = 10, .gap = {}});
  EXPECT_EQ(fast.survey().gaps.count, 1U);
  EXPECT_EQ(pass_of(fast), "2:0:10 3:10:10 4:20:10 5:30:10 6:140:10* 7:150:10 8:160:10 ");
}

TEST(Recording, TheMaximumIntervalRefusesNoRowAfterAGapThatIsSplit) {
  const WaypointTable table = table_at({0, 100, 200, 5200, 5300});
  const Preparation how{.intervals = {.most = seconds(1)}, .gap = {}};
  Recording split = recording_of(table, how);
  EXPECT_EQ(pass_of(split), "2:0:1 3:100:1 4:200:1 5:5200:1* 6:5300:1 ");
  Preparation bridge = how;
  bridge.gap.policy = GapPolicy::bridge;
  EXPECT_THROW((void)recording_of(table, bridge), InputError);
}

TEST(Recording, RefusesAGapWithTheRowsAroundIt) {
  const WaypointTable table = table_at({0, 100, 200, 5200, 5300});
  RefusedRows refused;
  try {
    (void)recording_of(table, {.gap = {.policy = GapPolicy::refuse}}, &refused);
    FAIL() << "accepted";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("a.csv:5: a gap of 5 s after a.csv:4"),
              std::string::npos)
        << error.what();
  }
}

TEST(Recording, LeavesOutTheSameRowsInEachPassAndReportsThemOnce) {
  WaypointTable table = table_at({0, 100, 100, 50, 200, 300, 400});
  table.positions[5] = std::numeric_limits<double>::quiet_NaN();
  RefusedRows refused;
  ::testing::internal::CaptureStderr();
  Recording recording = recording_of(table, {.gap = {}}, &refused);
  const std::string said = ::testing::internal::GetCapturedStderr();
  EXPECT_EQ(std::ranges::count(said, '\n'), 3) << said;
  ::testing::internal::CaptureStderr();
  for (int pass = 0; pass < 2; ++pass) {
    EXPECT_EQ(pass_of(recording), "2:0:1 3:100:1 6:200:1 8:400:1 ");
  }
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
  EXPECT_EQ(refused.count(RefusedBy::file), 3U);
}

TEST(Recording, ShiftsLateRowsByTheMedianInEachPass) {
  const WaypointTable table = table_at({0, 100, 200, 150, 250, 350});
  Recording recording = recording_of(table, {.late = LatePolicy::shift, .gap = {}});
  const std::string wanted = "2:0:1 3:100:1 4:200:1 5:300:1 6:400:1 7:500:1 ";
  EXPECT_EQ(pass_of(recording), wanted);
  EXPECT_EQ(pass_of(recording), wanted);
  EXPECT_EQ(recording.survey().late.shifts, 1U);
}

}  // namespace
}  // namespace splinecast::apps
