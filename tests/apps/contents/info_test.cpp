#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "apps/messages/json_fields.hpp"
#include "tests/fixtures/messages/mcap_file.hpp"
#include "tests/fixtures/messages/ulog_writer.hpp"
#include "tests/fixtures/processes/built_with.hpp"
#include "tests/fixtures/processes/process.hpp"
#include "tests/fixtures/processes/shared_files.hpp"

/// What `info` reports about a file.
namespace splinecast::apps {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;
using testing::Ended;
using testing::McapFile;
using testing::run;
using testing::UlogWriter;

class InfoOfFiles : public ::testing::Test {
 protected:
  [[nodiscard]] json info(const std::string& path) const {
    const Ended ended = run({"info", path, "--json"});
    EXPECT_EQ(ended.code, 0) << ended.err;
    return ended.code == 0 ? json::parse(ended.out) : json();
  }

  testing::TestFolder folder_;
};

TEST_F(InfoOfFiles, ListsTheTopicsOfAnMcapFile) {
  REQUIRE_MCAP();
  const std::string path = folder_.path("log.mcap");
  McapFile file(path);
  const auto fast = file.channel("/fast", "T", "json");
  const auto slow = file.channel("/slow", "U", "cdr");
  file.channel("/never", "U", "cdr");
  for (int i = 0; i < 100; ++i) {
    file.write(fast, 1000s + i * 10ms + (i >= 40 ? 2s : 0s) + (i >= 80 ? 3s : 0s), "{}");
    if (i % 50 == 0) file.write(slow, 1000s + i * 10ms, "message");
  }
  file.metadata("arm", {{"rate", "100"}});
  file.finish();
  const json read = info(path);
  EXPECT_EQ(read["format"], "MCAP");
  EXPECT_EQ(read["complete"], true);
  EXPECT_EQ(read["messages"], 102);
  EXPECT_EQ(read["first_ns"], 1'000'000'000'000);
  EXPECT_EQ(read["duration_ns"], 5'990'000'000);
  ASSERT_EQ(read["topics"].size(), 3U);
  const json& topic = read["topics"][0];
  EXPECT_EQ(topic["topic"], "/fast");
  EXPECT_EQ(topic["type"], "T");
  EXPECT_EQ(topic["encoding"], "json");
  EXPECT_EQ(topic["messages"], 100);
  EXPECT_NEAR(topic["rate_hz"], 99 / 5.99, 1e-9);
  EXPECT_EQ(topic["longest_pauses"],
            json::parse(R"([{"begin_ns":1002790000000,"length_ns":3010000000},
                            {"begin_ns":1000390000000,"length_ns":2010000000},
                            {"begin_ns":1000000000000,"length_ns":10000000}])"));
  EXPECT_EQ(read["topics"][2]["messages"], 0);
  EXPECT_EQ(read["topics"][2]["first_ns"], nullptr);
  EXPECT_EQ(read["metadata"], json::parse(R"([{"name":"arm","values":{"rate":"100"}}])"));
  const std::string text = run({"info", path}).out;
  EXPECT_NE(text.find("/fast   T     json           100   16.528    5.990000   3.010000  2.790000"),
            std::string::npos)
      << text;
}

TEST_F(InfoOfFiles, ReportsThatAFileIsCutOffOrDamaged) {
  REQUIRE_MCAP();
  const std::string path = folder_.path("log.mcap");
  McapFile file(path, mcap::Compression::none);
  const auto topic = file.channel("/a\x1b[31m", "T", "json");
  file.write(topic, 5s, "{}");
  file.write(topic, 4s, "{}");
  file.cut();
  json read = info(path);
  EXPECT_EQ(read["complete"], false);
  EXPECT_EQ(read["damage"], "");
  EXPECT_EQ(read["topics"][0]["not_increasing"], 1);
  const std::string text = run({"info", path}).out;
  EXPECT_NE(text.find("no: cut off (splinecast recover"), std::string::npos) << text;
  EXPECT_EQ(text.find('\x1b'), std::string::npos) << "control characters are escaped";
  std::fstream damaged(path, std::ios::in | std::ios::out | std::ios::binary);
  damaged.seekp(static_cast<std::streamoff>(std::filesystem::file_size(path) / 2));
  damaged.put('\xff').put('\xff');
  damaged.close();
  read = info(path);
  EXPECT_EQ(read["complete"], false);
  EXPECT_NE(read["damage"].get<std::string>().find("byte"), std::string::npos) << read["damage"];
}

TEST_F(InfoOfFiles, CountsTheEventsAndLossesOfARecording) {
  REQUIRE_MCAP();
  if (!can_read_json()) GTEST_SKIP() << "built without simdjson";
  const std::string path = folder_.path("run.mcap");
  McapFile file(path);
  const auto events = file.channel("/arm/events", "splinecast.Event", "json");
  for (const char* message :
       {R"({"time_ns":1,"event":"underrun"})", R"({"time_ns":2,"event":"underrun"})",
        R"({"time_ns":3,"event":"lost","reason":"queue full","count":7,"items":7})",
        R"({"time_ns":4,"event":"lost","reason":"late commit","count":2,"segments":2})"}) {
    file.write(events, 5s, message);
  }
  file.metadata("splinecast:arm", {{"epoch", "1"}});
  file.metadata("splinecast:arm", {{"epoch", "2"}});
  file.finish();
  const json read = info(path);
  EXPECT_EQ(read["events"], json::parse(R"({"lost":2,"underrun":2})"));
  EXPECT_EQ(read["lost"], 7);
  EXPECT_EQ(read["metadata"].size(), 2U);
  const std::string text = run({"info", path}).out;
  EXPECT_NE(text.find("events            lost 2, underrun 2\nlost              7\n"),
            std::string::npos)
      << text;
  EXPECT_EQ(text.find("epoch: 1"), std::string::npos) << "the text has the latest metadata";
}

TEST_F(InfoOfFiles, CountsTheDropoutsOfAUlog) {
  UlogWriter log;
  log.message('I',
              "\x0e"
              "char[3] sys_osNut")
      .format("a:uint64_t timestamp;float x;")
      .subscription(0, "a")
      .sample(0, 1000, 1.0F)
      .dropout(30)
      .sample(0, 41000, 1.0F)
      .dropout(5);
  const json read = info(folder_.write("log.ulg", log.bytes()));
  EXPECT_EQ(read["format"], "ULog");
  EXPECT_EQ(read["dropouts"], json::parse(R"({"count":2,"duration_ns":35000000})"));
  EXPECT_EQ(read["topics"][0]["longest_pauses"][0]["length_ns"], 40'000'000);
  EXPECT_EQ(read["metadata"][0]["values"]["sys_os"], "Nut");
}

TEST_F(InfoOfFiles, ShowsTheColumnsAndTheBadRowsOfATable) {
  const std::string path = folder_.write("moves.csv", "t,x,y\n0,0,1\n0.1,a,1\n0.2,0,1\n5,0,1\n");
  const json read = info(path);
  EXPECT_EQ(read["format"], "table");
  EXPECT_EQ(read["columns"], (json{"x", "y"}));
  EXPECT_EQ(read["bad_rows"], 1);
  EXPECT_EQ(read["messages"], 3);
  EXPECT_EQ(read["topics"][0]["longest_pauses"][0],
            json::parse(R"({"begin_ns":200000000,"length_ns":4800000000})"));
  const std::string text = run({"info", path}).out;
  EXPECT_NE(text.find("1; the first one: " + path + ":3:5: column 'x': 'a' is not a number"),
            std::string::npos)
      << text;
}

TEST_F(InfoOfFiles, RefusesWhatIsNeitherAStreamNorAFile) {
  const Ended no_file = run({"info", folder_.path("none.mcap")});
  EXPECT_EQ(no_file.code, 2);
  EXPECT_NE(no_file.err.find("no such file"), std::string::npos) << no_file.err;
  const Ended no_stream = run({"info", "splinecast_test_none"});
  EXPECT_NE(no_stream.err.find("there is no stream"), std::string::npos) << no_stream.err;
}

}  // namespace
}  // namespace splinecast::apps
