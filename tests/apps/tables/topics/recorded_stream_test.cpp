#include <fmt/format.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "apps/messages/json_fields.hpp"
#include "tests/fixtures/messages/mcap_file.hpp"
#include "tests/fixtures/messages/rows_of.hpp"
#include "tests/fixtures/processes/built_with.hpp"
#include "tests/fixtures/processes/process.hpp"

/// Rows of the recordings of this program.
namespace splinecast::apps {
namespace {

using testing::CopiedRow;
using testing::CopiedRows;
using testing::McapFile;
using testing::refusal_of;
using testing::rows_of;

constexpr std::string_view kSchema =
    R"({"type":"object","properties":{"position":{"type":"object","properties":{"z":{},"a.b":{}}}}})";

class Recordings : public ::testing::Test {
 protected:
  void SetUp() override {
    REQUIRE_MCAP();
    if (!can_read_json()) GTEST_SKIP() << "built without simdjson";
  }
  [[nodiscard]] std::string path() const { return folder_.path("run.mcap"); }

  /// A recording of the streams `arm` and `leg`, with these items of `arm`.
  void write(const std::vector<std::string>& items) const {
    McapFile file(path());
    const auto waypoints = file.channel("/arm/waypoints", "splinecast.Waypoint", "json", kSchema);
    const auto states = file.channel("/arm/states", "splinecast.State", "json", kSchema);
    const auto exact = file.channel("/arm/splinecast", "", "splinecast");
    for (const std::string& item : items) {
      file.write(waypoints, Time(7), item);
      file.write(states, Time(7), R"({"time_ns": 1, "position": {"z": 1, "a.b": 1}})");
      file.write(exact, Time(7), "bytes");
    }
    const auto leg = file.channel("/leg/waypoints", "splinecast.Waypoint", "json", kSchema);
    file.channel("/leg/splinecast", "", "splinecast");
    file.write(leg, Time(7), waypoint(5, 0.5));
    file.finish();
  }

  static std::string item(const std::string& kind, int time, double z) {
    return fmt::format(R"({{"time_ns":{},"kind":"{}","item":1,"position":{{"z":{},"a.b":{}}}}})",
                       time, kind, z, -z);
  }
  static std::string waypoint(int time, double z) { return item("waypoint", time, z); }
  static std::string replacement(int time) {
    return fmt::format(R"({{"time_ns":{},"kind":"replace","item":1,"count":1,"blend_ns":0}})",
                       time);
  }

 private:
  testing::TestFolder folder_;
};

TEST_F(Recordings, OfAStreamAreChosenByItsName) {
  write({waypoint(1, 0.1)});
  EXPECT_NE(refusal_of(path()).find("choose one of the topics with --topic"), std::string::npos);
  const CopiedRows arm = rows_of(path(), {.topic = "arm"});
  EXPECT_EQ(arm.names, (std::vector<std::string>{"z", "a.b"})) << "in the order of the schema";
  EXPECT_EQ(arm.rows, (std::vector<CopiedRow>{{1, Time(1), {0.1, -0.1}, {}, {}}}));
  EXPECT_EQ(rows_of(path(), {.topic = "/leg/waypoints"}).rows,
            (std::vector<CopiedRow>{{1, Time(5), {0.5, -0.5}, {}, {}}}));
  EXPECT_EQ(rows_of(path(), {.columns = {"a.b"}, .topic = "arm"}).rows,
            (std::vector<CopiedRow>{{1, Time(1), {-0.1}, {}, {}}}));
  EXPECT_NE(refusal_of(path(), {.columns = {"y"}, .topic = "arm"}).find("no dimension 'y'"),
            std::string::npos);
  EXPECT_EQ(rows_of(path(), {.topic = "arm", .which_time = WhichTime::log}).rows[0].time, Time(7));
}

TEST_F(Recordings, HaveTheKindsAndUnitsOfTheStream) {
  McapFile file(path());
  const auto topic = file.channel("/arm/waypoints", "splinecast.Waypoint", "json", kSchema);
  file.metadata("splinecast:arm",
                {{"dimensions", R"([{"name":"z","unit":"deg","kind":"periodic","period":360},
                                    {"name":"a.b","unit":"","kind":"linear","period":0}])"}});
  file.write(topic, Time(7), waypoint(1, 2));
  file.finish();
  const CopiedRows read = rows_of(path(), {.columns = {"a.b", "z"}});
  EXPECT_EQ(read.names, (std::vector<std::string>{"a.b", "z [deg]"}));
  EXPECT_EQ(read.kinds[0].kind, DimensionKind::linear);
  EXPECT_EQ(read.kinds[1].kind, DimensionKind::periodic);
  EXPECT_EQ(read.kinds[1].period, 360);
}

TEST_F(Recordings, HaveTheDerivativesOfTheWaypointsThatHaveThem) {
  write(
      {R"({"time_ns":1,"kind":"start_state","item":1,"position":{"z":1,"a.b":2},"velocity":{"z":3,"a.b":4},"acceleration":{"z":5,"a.b":6}})",
       waypoint(2, 7),
       R"({"time_ns":3,"kind":"waypoint","item":3,"position":{"z":8,"a.b":9},"velocity":{"z":-0.0,"a.b":1e-300}})",
       R"({"time_ns":4,"kind":"finish","item":4,"condition":"halt"})"});
  EXPECT_EQ(rows_of(path(), {.topic = "arm"}).rows,
            (std::vector<CopiedRow>{{1, Time(1), {1, 2}, {3, 4}, {5, 6}},
                                    {2, Time(2), {7, -7}, {}, {}},
                                    {3, Time(3), {8, 9}, {-0.0, 1e-300}, {}}}));
}

TEST_F(Recordings, LeaveOutWhatAReplacementReplaces) {
  write({waypoint(10, 1), waypoint(20, 2), waypoint(30, 3), waypoint(40, 4), replacement(30),
         waypoint(35, 5), waypoint(45, 6), replacement(20), waypoint(50, 7), replacement(60),
         waypoint(70, 8)});
  const std::vector<CopiedRow> expected{{1, Time(10), {1, -1}, {}, {}},
                                        {9, Time(50), {7, -7}, {}, {}},
                                        {11, Time(70), {8, -8}, {}, {}}};
  const auto reader = open_rows(path(), {.topic = "arm", .quiet = true});
  for (int pass = 0; pass < 2; ++pass) {
    CopiedRows read;
    testing::copy_rows(*reader, read);
    EXPECT_EQ(read.rows, expected);
    EXPECT_TRUE(read.errors.empty());
    reader->rewind();
  }
}

}  // namespace
}  // namespace splinecast::apps
