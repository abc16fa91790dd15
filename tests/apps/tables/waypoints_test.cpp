#include "apps/tables/waypoints.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/fixtures/processes/process.hpp"

namespace splinecast::apps {
namespace {

using testing::TestFolder;

std::string error_of(const std::string& path, const TableOptions& options = {}) {
  try {
    (void)read_waypoints(path, options);
  } catch (const InputError& error) {
    return error.what();
  }
  return "read without an error";
}

TEST(WaypointTable, TakesTheTimeUnitFromTheColumnsName) {
  const TestFolder folder;
  const std::vector<std::pair<const char*, std::int64_t>> headers{{"t_ns,x", 3},
                                                                  {"timestamp_us,x", 3'000},
                                                                  {"#timestamp [ns],x", 3},
                                                                  {"time_ms,x", 3'000'000},
                                                                  {"t,x", 3'000'000'000},
                                                                  {"time,x", 3'000'000'000},
                                                                  {"timestamp,x", 3'000'000'000},
                                                                  {"# Timestamp [us] , x", 3'000},
                                                                  {"\xef\xbb\xbft_ns,x", 3}};
  for (const auto& [header, wanted] : headers) {
    const auto path = folder.write("a.csv", std::string(header) + "\n3,1\n");
    const auto table = read_waypoints(path, {});
    EXPECT_EQ(table.times.at(0).count(), wanted) << header;
    EXPECT_EQ(table.names, std::vector<std::string>{"x"}) << header;
  }
  const auto path = folder.write("a.csv", "t,x\n3,1\n");
  EXPECT_EQ(read_waypoints(path, {.time_unit = TimeUnit::microseconds}).times.at(0), Time(3000));
}

TEST(WaypointTable, EveryOtherNumericColumnIsAPositionUnlessSelected) {
  const TestFolder folder;
  const auto path = folder.write("a.csv",
                                 "name,x,t,y,v[0],v[1],a[0],a[1]\r\nfoo, 1 ,0.5,2,3,4,5,6\r\n\r\n# "
                                 "note\r\nbar,7,1,8,9,10,11,12");
  const auto table = read_waypoints(path, {});
  EXPECT_EQ(table.names, (std::vector<std::string>{"x", "y"}));
  EXPECT_EQ(table.positions, (std::vector<double>{1, 2, 7, 8}));
  EXPECT_EQ(table.velocities, (std::vector<double>{3, 4, 9, 10}));
  EXPECT_EQ(table.accelerations, (std::vector<double>{5, 6, 11, 12}));
  EXPECT_EQ(table.lines, (std::vector<std::size_t>{2, 5}));
  const auto selected = read_waypoints(path, {.columns = {"y"}});
  EXPECT_EQ(selected.positions, (std::vector<double>{2, 8}));
  EXPECT_EQ(selected.velocities, (std::vector<double>{4, 10}));
}

TEST(WaypointTable, ReadsItsOwnSamplesWithoutTheirJerk) {
  const TestFolder folder;
  const auto path = folder.write("a.csv", "t_ns,p[0],v[0],a[0],j[0],status\n1,2,3,4,5,settled\n");
  const auto table = read_waypoints(path, {});
  EXPECT_EQ(table.names, std::vector<std::string>{"p[0]"});
  EXPECT_EQ(table.velocities, std::vector<double>{3});
}

TEST(WaypointTable, ReadsTumTextWithItsOwnNamesOrTheComments) {
  const TestFolder folder;
  const auto path = folder.write("a.txt",
                                 "# ground truth\n# timestamp tx ty tz qx qy qz qw\n"
                                 "1305031098.6659 1 2 3 0 0 0 1\n1305031098.6758  4 5 6 0 0 0 1\n");
  EXPECT_EQ(read_waypoints(path, {}).dimensions(), 7U);
  for (const auto& columns :
       {std::vector<std::string>{"x", "z"}, std::vector<std::string>{"tx", "tz"}}) {
    const auto table = read_waypoints(path, {.columns = columns});
    EXPECT_EQ(table.positions, (std::vector<double>{1, 3, 4, 6}));
    EXPECT_EQ(table.times.at(1).count(), 1305031098675800000);
  }
}

TEST(WaypointTable, ReportsFileLineAndColumnOfUnreadableInput) {
  const TestFolder folder;
  const auto message = [&](const std::string& text, const TableOptions& options = {}) {
    return error_of(folder.write("bad.csv", text), options);
  };
  EXPECT_NE(message("t,x\n1,2\n2,abc\n").find("bad.csv:3:3: column 'x': 'abc' is not a number"),
            std::string::npos);
  EXPECT_NE(message("t,x\n1,2\noops,3\n").find("bad.csv:3:1: column 't': 'oops' is not a time"),
            std::string::npos);
  EXPECT_NE(message("t,x\n1,2\n2\n").find("bad.csv:3:1: 1 fields, but there are 2 columns"),
            std::string::npos);
  EXPECT_NE(message("t,x\n1,2\n2,\n").find("bad.csv:3:3: column 'x': ''"), std::string::npos);
  EXPECT_NE(message("a,b\n1,2\n").find("no time column"), std::string::npos);
  EXPECT_NE(message("1,2\n").find("bad.csv:1: there is no header"), std::string::npos);
  EXPECT_NE(message("").find("no rows"), std::string::npos);
  EXPECT_NE(message("t,x\n").find("there are no waypoints"), std::string::npos);
  EXPECT_NE(message("t\n1\n").find("no position column"), std::string::npos);
  EXPECT_NE(message("t,x,x\n1,2,3\n").find("two columns are named 'x'"), std::string::npos);
  EXPECT_NE(message("t,x\n1,2\n", {.columns = {"y"}}).find("no column 'y' among t, x"),
            std::string::npos);
  EXPECT_NE(message("t,x,y,v[0]\n1,2,3,4\n").find("1 columns v[i] for 2 positions"),
            std::string::npos);
  EXPECT_NE(message("1 2 3\n").find("nor TUM text"), std::string::npos);
  EXPECT_NE(error_of(folder.path("none.csv")).find("no such file"), std::string::npos);
}

TEST(WaypointTable, QuotedNamesMayContainCommasAndCommentsMayFollowTheHeader) {
  const TestFolder folder;
  const auto quoted = folder.write("q.csv", "\"t\",\"a,b\",\"y\"\n0,1,2\n");
  EXPECT_EQ(read_waypoints(quoted, {}).names, (std::vector<std::string>{"a,b", "y"}));
  const auto commented = folder.write("c.csv", "#t,x,y\n# robot 3, left arm\n0,1,2\n");
  EXPECT_EQ(read_waypoints(commented, {}).names, (std::vector<std::string>{"x", "y"}));
}

TEST(WaypointTable, ABadFirstCellIsAnErrorAndNotAMissingDimension) {
  const TestFolder folder;
  const auto path = folder.write("a.csv", "t,a,x\n0,0,\n1,1,2\n");
  EXPECT_NE(error_of(path).find("a.csv:2:5: column 'x': '' is not a number"), std::string::npos);
  EXPECT_NE(error_of(path, {.columns = {"a", "a"}}).find("selected twice"), std::string::npos);
  EXPECT_NE(error_of(path, {.columns = {"t"}}).find("is the time"), std::string::npos);
}

TEST(WaypointTable, TimesWhoseDifferencesOverflowAreRefused) {
  const TestFolder folder;
  const auto path = folder.write("a.csv", "t,x\n-9223372036,1\n9223372036,2\n");
  EXPECT_NE(error_of(path).find("a.csv:2:1: column 't': '-9223372036' is not within"),
            std::string::npos);
}

TEST(WaypointTable, SkipsUnreadableRowsOnRequest) {
  const TestFolder folder;
  const auto path = folder.write("a.csv", "t,x\n1,2\n2,abc\n3,4\n4\n5,6\n");
  std::vector<std::size_t> lines;
  const auto table =
      read_waypoints(path, {.on_bad_row = [&](std::size_t line, const InputError& error) {
                       lines.push_back(line);
                       const std::string where = "a.csv:" + std::to_string(line) + ":";
                       EXPECT_NE(std::string(error.what()).find(where), std::string::npos);
                     }});
  EXPECT_EQ(table.positions, (std::vector<double>{2, 4, 6}));
  EXPECT_EQ(lines, (std::vector<std::size_t>{3, 5}));
}

}  // namespace
}  // namespace splinecast::apps
