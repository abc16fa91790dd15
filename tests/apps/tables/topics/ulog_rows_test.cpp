#include <gtest/gtest.h>

#include <fstream>
#include <string>
#include <vector>

#include "tests/fixtures/messages/rows_of.hpp"
#include "tests/fixtures/messages/ulog_writer.hpp"
#include "tests/fixtures/processes/process.hpp"
#include "tests/fixtures/processes/shared_files.hpp"

/// Rows of the topics of logs of PX4.
namespace splinecast::apps {
namespace {

using namespace std::chrono_literals;
using testing::CopiedRows;
using testing::refusal_of;
using testing::rows_of;
using testing::UlogWriter;

using Names = std::vector<std::string>;
using Table = std::vector<std::vector<double>>;

class UlogTopics : public ::testing::Test {
 protected:
  [[nodiscard]] std::string path() const { return folder_.path("log.ulg"); }
  void write(const UlogWriter& log) const {
    std::ofstream(path(), std::ios::binary) << log.bytes();
  }
  static UlogWriter small_log() {
    UlogWriter log;
    log.format("motion:uint64_t timestamp;uint64_t timestamp_sample;float[4] q;double x;uint8_t n;")
        .subscription(0, "motion")
        .subscription(1, "motion", 1);
    for (std::uint64_t i = 0; i < 5; ++i) {
      const auto value = static_cast<double>(i);
      log.sample(0, 1000 * i + 500, 1000 * i, 1.0F, 0.0F, 0.0F, 0.0F, value, std::uint8_t{7});
      log.sample(1, 1000 * i + 600, 1000 * i, 0.0F, 1.0F, 0.0F, 0.0F, -value, std::uint8_t{8});
    }
    return log;
  }

 private:
  testing::TestFolder folder_;
};

TEST_F(UlogTopics, HaveTheFieldsOfAnInstance) {
  write(small_log());
  EXPECT_EQ(refusal_of(path()), path() +
                                    ": choose one of the topics with --topic:"
                                    "\n  motion (8 fields): 5 messages"
                                    "\n  motion:1 (8 fields): 5 messages");
  const CopiedRows read = rows_of(path(), {.topic = "motion:1"});
  EXPECT_EQ(read.names, (Names{"q[0]", "q[1]", "q[2]", "q[3]", "x"}));
  EXPECT_EQ(read.kinds[0].kind, DimensionKind::quaternion_wxyz);
  EXPECT_EQ(read.kinds[4].kind, DimensionKind::linear);
  ASSERT_EQ(read.rows.size(), 5U);
  EXPECT_EQ(read.rows[3].time, 3600us);
  EXPECT_EQ(read.rows[3].position, (std::vector<double>{0, 1, 0, 0, -3}));
  EXPECT_EQ(rows_of(path(), {.topic = "motion:0", .fields = {"n", "x"}}).rows[1].position,
            (std::vector<double>{7, 1}));
}

TEST_F(UlogTopics, HaveTheTimeOfAField) {
  write(small_log());
  EXPECT_EQ(rows_of(path(), {.time_column = "timestamp_sample", .topic = "motion"}).rows[2].time,
            2ms);
  EXPECT_NE(refusal_of(path(), {.time_column = "x", .topic = "motion"})
                .find("there is no integer field 'x' for the time"),
            std::string::npos);
  EXPECT_NE(refusal_of(path(), {.topic = "motion", .which_time = WhichTime::log})
                .find("a ULog has no log time"),
            std::string::npos);
  EXPECT_NE(refusal_of(path(), {.topic = "motion", .fields = {"y"}})
                .find("topic motion: there is no field 'y' among timestamp, "),
            std::string::npos);
}

TEST_F(UlogTopics, WithABadSampleContinueAfterIt) {
  UlogWriter log = small_log();
  log.message('D', std::string("\x09\x00zzzz", 6));
  log.sample(0, ~0ULL, 1ULL, 1.0F, 0.0F, 0.0F, 0.0F, 1.0, std::uint8_t{7});
  log.sample(0, 9000, 1ULL, 1.0F, 0.0F, 0.0F, 0.0F, 1.0, std::uint8_t{7});
  write(log);
  const CopiedRows read = rows_of(path(), {.topic = "motion"});
  EXPECT_EQ(read.rows.size(), 6U);
  ASSERT_EQ(read.errors.size(), 2U);
  EXPECT_NE(read.errors[0].find("message id 9, which has no subscription"), std::string::npos);
  EXPECT_EQ(read.errors[1],
            path() +
                ": message 6 of motion: field 'timestamp' is not within ±(2^62 − 1) "
                "ns, about 146 years");
}

TEST_F(UlogTopics, ThatAreCutOffAreReportedOnStandardError) {
  write(small_log().raw("\x09"));
  const testing::Ended reported =
      testing::run({"fit", path(), "--topic", "motion", "--dt", "0.001"});
  EXPECT_EQ(reported.code, 0) << reported.err;
  EXPECT_NE(reported.err.find(path() + ": the file is cut off"), std::string::npos) << reported.err;
}

TEST_F(UlogTopics, OfARealFlightHaveTheValuesOfItsCsvFiles) {
  const auto log = testing::shared_file("data/px4_drone_log/sample_log_small.ulg");
  REQUIRE_SHARED_FILE(log);
  const std::string folder = log.parent_path().string() + "/";
  for (const auto& [topic, fields] :
       {std::pair<std::string, Names>{"vehicle_local_position",
                                      {"x", "y", "z", "vx", "vy", "vz", "ax", "ay", "az"}},
        std::pair<std::string, Names>{"vehicle_attitude", {"q"}}}) {
    const CopiedRows of_log = rows_of(log, {.topic = topic, .fields = fields});
    const CopiedRows of_csv = rows_of(folder + topic + ".csv", {.columns = of_log.names});
    EXPECT_GT(of_log.rows.size(), 600U);
    EXPECT_EQ(of_log.times(), of_csv.times());
    EXPECT_EQ(of_log.positions(), of_csv.positions());
  }
}

}  // namespace
}  // namespace splinecast::apps
